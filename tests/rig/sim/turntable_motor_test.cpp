// Proves what a simulated controller does with the mock table's motor: moves at a speed of their
// own, braking along the profile's ramp, cuts, counts declared anew, displacements by hand. Does
// not prove what the controllers make of it; their tests do.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "rig/sim/mock_turntable.h"

namespace turnlight::rig::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

MockTurntableConfig RigidMotor(TableFeedback feedback = TableFeedback::kOpenLoop) {
  MockTurntableConfig config;
  config.backlash_deg = 0.0;
  config.settle_amplitude_deg = 0.0;
  config.feedback = feedback;
  return config;
}

std::shared_ptr<FaultScript> Script(FaultKind kind) {
  return std::make_shared<FaultScript>(std::vector<FaultEntry>{MakeFault(kind)});
}

constexpr DeviceTime kBegin = seconds(10);

TEST(TurntableMotor, MovesWithoutHomingFromWhereItStands) {
  MockTurntable table(RigidMotor());
  const double before = table.TrueAngleDeg(kBegin);
  EXPECT_EQ(table.Motor(kBegin).counted_deg, 0.0);
  table.SetCount(5.0, kBegin);
  EXPECT_NEAR(table.TrueAngleDeg(kBegin), before, 0.005 + 1e-9);  // half a step
  table.Drive(25.0, 10.0, 100.0, kBegin);
  const TrapezoidalProfile profile(20.0, 10.0, 100.0);
  for (int ms = 0; ms < 3000; ms += 50)
    EXPECT_NEAR(table.TrueAngleDeg(kBegin + milliseconds(ms)) - table.TrueAngleDeg(kBegin),
                profile.At(1e-3 * ms), 1e-6);
  const auto halfway = table.Motor(kBegin + seconds(1));
  EXPECT_TRUE(halfway.moving);
  EXPECT_NEAR(halfway.speed_deg_s, 10.0, 1e-3);
  EXPECT_NEAR(halfway.counted_deg, 14.5, 0.011);
  const auto there = table.Motor(kBegin + seconds(3));
  EXPECT_FALSE(there.moving);
  EXPECT_EQ(there.counted_deg, 25.0);
  EXPECT_FALSE(there.stopped_by);
}

TEST(TurntableMotor, BrakesAlongTheRampAndCountsIt) {
  for (const double sign : {1.0, -1.0}) {
    MockTurntable table(RigidMotor());
    table.SearchHome(60.0, 120.0, kBegin);
    const DeviceTime start = kBegin + seconds(20);
    table.Drive(sign * 90.0, 30.0, 60.0, start);
    const DeviceTime now = start + milliseconds(1500);
    const double at = table.TrueAngleDeg(now);
    table.Brake(now);
    // v2 / 2a = 7.5 deg in 0.5 s.
    EXPECT_TRUE(table.Motor(now + milliseconds(490)).moving);
    const auto rest = table.Motor(now + milliseconds(510));
    EXPECT_FALSE(rest.moving);
    EXPECT_NEAR(rest.counted_deg, at + sign * 7.5, 0.02);
    EXPECT_EQ(table.TrueAngleDeg(now + seconds(1)), rest.counted_deg);
    double previous = at;
    for (DeviceTime t = now; t < now + milliseconds(600); t += milliseconds(1)) {
      const double angle = table.TrueAngleDeg(t);
      EXPECT_LE(std::abs(angle - previous), 0.04);
      EXPECT_GE(sign * (angle - previous), -0.011);  // a cut is on a whole step
      previous = angle;
    }
  }
}

TEST(TurntableMotor, BrakingEndsNoLaterThanTheMoveWouldHave) {
  MockTurntable table(RigidMotor());
  table.SearchHome(60.0, 120.0, kBegin);
  const DeviceTime start = kBegin + seconds(20);
  table.Drive(90.0, 30.0, 60.0, start);
  const DeviceTime now = start + milliseconds(3300);  // 0.2 s before the end
  table.Brake(now);
  EXPECT_NEAR(table.Motor(now + seconds(1)).counted_deg, 90.0, 0.011);
  table.Brake(now + seconds(2));  // at rest: nothing
  EXPECT_NEAR(table.Motor(now + seconds(3)).counted_deg, 90.0, 0.011);
}

TEST(TurntableMotor, ACutStandsAtOnceOnAWholeStepAndANewMoveGoesOn) {
  MockTurntable table(RigidMotor());
  table.SearchHome(60.0, 120.0, kBegin);
  const DeviceTime start = kBegin + seconds(20);
  table.Drive(90.0, 30.0, 60.0, start);
  table.Cut(start + seconds(1));
  const double stands = table.TrueAngleDeg(start + seconds(1));
  EXPECT_NEAR(stands, 22.5, 0.011);
  EXPECT_EQ(table.TrueAngleDeg(start + seconds(5)), stands);
  EXPECT_EQ(table.Motor(start + seconds(5)).counted_deg, stands);
  table.Drive(10.0, 30.0, 60.0, start + seconds(6));
  table.Drive(0.0, 30.0, 60.0, start + milliseconds(6300));
  EXPECT_EQ(table.TrueAngleDeg(start + seconds(9)), 0.0);
}

TEST(TurntableMotor, TellsWhatStoppedIt) {
  for (const FaultKind kind : {FaultKind::kAlarm, FaultKind::kLimit, FaultKind::kReset,
                               FaultKind::kStall, FaultKind::kDisplaced}) {
    MockTurntable table(RigidMotor(TableFeedback::kEncoder), Script(kind));
    table.SearchHome(60.0, 120.0, kBegin);
    const DeviceTime start = kBegin + seconds(20);
    table.Drive(20.0, 30.0, 60.0, start);
    EXPECT_FALSE(table.Motor(start + milliseconds(1)).stopped_by);
    const auto state = table.Motor(start + seconds(5));
    EXPECT_EQ(state.stopped_by, kind) << FaultWord(kind);
    EXPECT_EQ(state.counted_deg, kind == FaultKind::kDisplaced ? 20.5 : 10.0);
    EXPECT_EQ(table.TrueAngleDeg(start + seconds(5)), state.counted_deg);
    table.Drive(20.0, 30.0, 60.0, start + seconds(6));
    EXPECT_FALSE(table.Motor(start + seconds(9)).stopped_by);
    EXPECT_EQ(table.TrueAngleDeg(start + seconds(9)), 20.0);
  }
  MockTurntable stuck(RigidMotor(), Script(FaultKind::kStuckSwitch));
  stuck.SearchHome(60.0, 120.0, kBegin);
  EXPECT_EQ(stuck.Motor(kBegin + seconds(20)).stopped_by, FaultKind::kStuckSwitch);
}

TEST(TurntableMotor, OpenLoopDoesNotSeeADisplacement) {
  MockTurntable table(RigidMotor(), Script(FaultKind::kDisplaced));
  table.SearchHome(60.0, 120.0, kBegin);
  table.Drive(20.0, 30.0, 60.0, kBegin + seconds(20));
  EXPECT_EQ(table.Motor(kBegin + seconds(30)).counted_deg, 20.0);
  EXPECT_EQ(table.TrueAngleDeg(kBegin + seconds(30)), 20.5);
}

}  // namespace
}  // namespace turnlight::rig::sim
