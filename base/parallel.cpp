#include "base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <memory>
#include <mutex>

namespace turnlight {
namespace {

struct Pool {
  std::mutex mutex;
  int threads = 0;
  std::shared_ptr<tbb::task_arena> arena;
  // oneTBB otherwise starts no more workers than there are processors, whatever an arena asks for.
  std::unique_ptr<tbb::global_control> limit;
};

// The arena is process-wide on purpose: a machine has one set of cores.
Pool& ThePool() {
  static Pool pool;
  return pool;
}

// Shared, so that a loop that still runs keeps its arena when SetThreads replaces it.
std::shared_ptr<tbb::task_arena> Arena() {
  Pool& pool = ThePool();
  const std::lock_guard lock(pool.mutex);
  if (!pool.arena) {
    const int threads = pool.threads > 0 ? pool.threads : tbb::info::default_concurrency();
    pool.limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                       static_cast<std::size_t>(threads));
    pool.arena = std::make_shared<tbb::task_arena>(threads);
  }
  return pool.arena;
}

}  // namespace

void SetThreads(int threads) {
  Pool& pool = ThePool();
  const std::lock_guard lock(pool.mutex);
  pool.threads = threads > 0 ? threads : 0;
  pool.arena.reset();
}

int Threads() { return Arena()->max_concurrency(); }

void ParallelFor(std::size_t count, const std::function<void(std::size_t)>& body) {
  Arena()->execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                        for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
                      });
  });
}

}  // namespace turnlight
