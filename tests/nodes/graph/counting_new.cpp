// Replaces operator new in the program that it is linked into, to count its calls. In a file of its
// own: g++ 12 warns of mismatched pairs where it can inline one half of these.
#include <atomic>
#include <cstdlib>
#include <new>

std::atomic<std::size_t> counted_allocations{0};

void* operator new(std::size_t size) {
  counted_allocations.fetch_add(1, std::memory_order_relaxed);
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
