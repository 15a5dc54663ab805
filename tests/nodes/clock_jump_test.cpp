// Proves: a capture in real time does not care what time of day it is. Here UTC jumps by a day,
// back and forth, at every look at it; the frames are those of virtual time, none is taken twice,
// and times never go back. Stands alone, because it puts its own clock in the place of the
// system's.
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <set>

#include "mock_rig.h"
#include "static_render.h"

namespace {
std::atomic<int> looks_at_utc{0};
}  // namespace

// The system's, with jumps in the time of day.
extern "C" int clock_gettime(clockid_t clock, timespec* time) {
  const auto result = static_cast<int>(::syscall(SYS_clock_gettime, clock, time));
  if (clock == CLOCK_REALTIME) time->tv_sec += looks_at_utc++ % 2 == 0 ? -86400 : 86400;
  return result;
}

namespace turnlight::nodes {
namespace {

TEST(ClockJump, TimeOfDayIsALabelOnly) {
  MockRigOptions options = SmallCapture();
  options.executor = "wall";
  options.table.max_speed_deg_s = 1000.0;
  options.table.home_speed_deg_s = 1000.0;
  options.table.settle_ms = 10.0;
  options.plan.settle_ms = 20.0;
  options.plan.frame_timeout_s = 20.0;
  const MockRigRun run = RunMockRig(options);
  ASSERT_FALSE(run.report.failure) << run.report.failure->text;
  ASSERT_EQ(run.brackets.size(), 4u);
  EXPECT_EQ(run.Rejected(), 0u);
  EXPECT_LT(WorstSigmas(run.brackets, run.camera->config()), 5.0);
  std::set<std::string> days;
  rig::DeviceTime before{0};
  for (const Bracket& bracket : run.brackets) {
    days.insert(bracket.utc.substr(0, 10));
    EXPECT_GT(bracket.exposures.front().exposure_begin, before);
    before = bracket.exposures.front().exposure_end;
  }
  EXPECT_GE(days.size(), 2u) << "the clock did not jump";
}

}  // namespace
}  // namespace turnlight::nodes
