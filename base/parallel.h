// Parallel loops whose results do not depend on the number of threads: work is cut into fixed
// chunks, each chunk writes only its own slot, and whoever reduces does so in the order of the
// chunks.
#pragma once

#include <cstddef>
#include <functional>

namespace turnlight {

// Limits the worker threads of the calls that follow, in this process. 0 means one per processor.
void SetThreads(int threads);
int Threads();

// Calls body(i) once for each i in [0, count), in any order, on any thread. body must not throw.
void ParallelFor(std::size_t count, const std::function<void(std::size_t)>& body);

}  // namespace turnlight
