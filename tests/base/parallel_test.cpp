// Proves: each index is visited exactly once with any number of threads, loops nest, and a loop
// outlives a change of the thread count.
// Does not prove: that loops are fast.
#include "base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

namespace turnlight {
namespace {

class Parallel : public testing::Test {
 protected:
  void TearDown() override { SetThreads(0); }
};

TEST_F(Parallel, EachIndexOnce) {
  for (const int threads : {0, 1, 2, 7}) {
    SetThreads(threads);
    if (threads > 0) {
      EXPECT_EQ(Threads(), threads);
    }
    for (const std::size_t count : {0u, 1u, 2u, 1000u}) {
      std::vector<std::atomic<int>> visits(count);
      ParallelFor(count, [&](std::size_t i) { ++visits[i]; });
      for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(visits[i], 1) << threads << " " << i;
    }
  }
}

TEST_F(Parallel, OneThreadIsOneThread) {
  SetThreads(1);
  std::mutex mutex;
  std::set<std::thread::id> ids;
  ParallelFor(1000, [&](std::size_t) {
    const std::lock_guard lock(mutex);
    ids.insert(std::this_thread::get_id());
  });
  EXPECT_EQ(ids.size(), 1u);
}

TEST_F(Parallel, NegativeMeansAll) {
  SetThreads(0);
  const int all = Threads();
  SetThreads(-3);
  EXPECT_EQ(Threads(), all);
  EXPECT_GE(all, 1);
}

TEST_F(Parallel, Nests) {
  SetThreads(3);
  std::vector<std::atomic<int>> visits(400);
  ParallelFor(
      20, [&](std::size_t i) { ParallelFor(20, [&](std::size_t j) { ++visits[20 * i + j]; }); });
  for (const auto& count : visits) EXPECT_EQ(count, 1);
}

TEST_F(Parallel, ThreadsMayChangeDuringALoop) {
  SetThreads(2);
  std::atomic<int> visits = 0;
  ParallelFor(100, [&](std::size_t i) {
    if (i == 50) SetThreads(1);
    ++visits;
  });
  EXPECT_EQ(visits, 100);
  EXPECT_EQ(Threads(), 1);
}

}  // namespace
}  // namespace turnlight
