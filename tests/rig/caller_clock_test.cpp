// Proves: times come out in the caller's clock, steadily, though calls are late by varying amounts;
// a clock that begins anew is taken as it is.
#include "rig/caller_clock.h"

#include <gtest/gtest.h>

namespace turnlight::rig {
namespace {

using std::chrono::milliseconds;

CallerClock::Steady::time_point At(int ms) {
  return CallerClock::Steady::time_point(milliseconds(ms));
}

TEST(CallerClock, TheLeastLateCallIsTheTruest) {
  CallerClock clock;
  clock.Hear(milliseconds(100), At(1103));
  EXPECT_EQ(clock.ToCaller(At(1103)), milliseconds(100));
  clock.Hear(milliseconds(200), At(1201));
  EXPECT_EQ(clock.ToCaller(At(1103)), milliseconds(102));
  clock.Hear(milliseconds(300), At(1320));
  EXPECT_EQ(clock.ToCaller(At(1103)), milliseconds(102));
}

TEST(CallerClock, AClockThatBeginsAnewIsBelieved) {
  CallerClock clock;
  clock.Hear(milliseconds(0), At(1000));  // opened
  clock.Hear(milliseconds(0), At(1800));  // the graph begins
  EXPECT_EQ(clock.ToCaller(At(1810)), milliseconds(10));
}

TEST(CallerClock, ACallThatWasHeldUpIsMendedByTheNext) {
  CallerClock clock;
  clock.Hear(milliseconds(0), At(1000));
  clock.Hear(milliseconds(10), At(1200));
  EXPECT_LT(clock.ToCaller(At(1200)), milliseconds(200));  // early, never late
  clock.Hear(milliseconds(300), At(1300));
  EXPECT_EQ(clock.ToCaller(At(1200)), milliseconds(200));
}

}  // namespace
}  // namespace turnlight::rig
