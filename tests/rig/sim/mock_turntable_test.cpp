// Proves that the mock table's truth is the closed form it claims (profile, steps, backlash,
// swing, homing), that its report is the controller's and not the truth, and that each table fault
// has its effect and is over after homing. Does not prove that real tables behave so.
#include "rig/sim/mock_turntable.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <thread>

namespace turnlight::rig::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::HasSubstr;

// A table under test and the time it lives in.
struct TableBench {
  explicit TableBench(MockTurntableConfig config = {}, std::vector<FaultEntry> entries = {})
      : faults(std::make_shared<FaultScript>(std::move(entries))), table(config, faults) {}

  TableState State() {
    const auto state = table.State(now);
    EXPECT_TRUE(state) << state.error().text;
    if (!state) std::abort();
    return *state;
  }
  // Polls every millisecond until the table no longer moves, then lets it settle.
  TableState Settle() {
    for (int i = 0; i < 60000 && State().motion == TableMotion::kMoving; ++i)
      now += milliseconds(1);
    arrived = now;
    now += seconds(1);
    return State();
  }
  void Start() {
    ASSERT_TRUE(table.Open(now));
    Home();
  }
  void Home() {
    const Status status = table.Home(now);
    ASSERT_TRUE(status) << status.error().text;
    Settle();
  }
  TableState Move(double angle_deg) {
    const Status status = table.MoveTo(angle_deg, now);
    EXPECT_TRUE(status) << status.error().text;
    return Settle();
  }
  double True() const { return table.TrueAngleDeg(now); }

  std::shared_ptr<FaultScript> faults;
  MockTurntable table;
  DeviceTime now{seconds(1)};
  DeviceTime arrived{};
};

MockTurntableConfig Rigid() {
  MockTurntableConfig config;
  config.backlash_deg = 0.0;
  config.settle_amplitude_deg = 0.0;
  return config;
}

MockTurntableConfig OpenLoop() {
  MockTurntableConfig config = Rigid();
  config.feedback = TableFeedback::kOpenLoop;
  return config;
}

FaultEntry TableFaultAt(FaultKind kind, double angle_deg) {
  FaultEntry entry = MakeFault(kind);
  entry.angle_deg = angle_deg;
  return entry;
}

TEST(TrapezoidalProfile, MatchesTheClosedFormWithAndWithoutCruise) {
  // 100 deg at most 20 deg/s and 10 deg/s^2: 2 s and 20 deg each of ramp, 60 deg = 3 s of cruise.
  const TrapezoidalProfile longer(100.0, 20.0, 10.0);
  EXPECT_DOUBLE_EQ(longer.Duration(), 7.0);
  EXPECT_DOUBLE_EQ(longer.At(1.0), 5.0);
  EXPECT_DOUBLE_EQ(longer.At(2.0), 20.0);
  EXPECT_DOUBLE_EQ(longer.At(3.5), 50.0);
  EXPECT_DOUBLE_EQ(longer.At(6.0), 95.0);
  EXPECT_EQ(longer.At(7.0), 100.0);
  EXPECT_EQ(longer.At(1e9), 100.0);
  EXPECT_EQ(longer.At(-1.0), 0.0);
  // 10 deg never reach 20 deg/s: 1 s up, 1 s down.
  const TrapezoidalProfile shorter(10.0, 20.0, 10.0);
  EXPECT_DOUBLE_EQ(shorter.Duration(), 2.0);
  EXPECT_DOUBLE_EQ(shorter.At(1.0), 5.0);
  EXPECT_DOUBLE_EQ(shorter.At(1.5), 8.75);
  EXPECT_EQ(TrapezoidalProfile(0.0, 20.0, 10.0).At(0.5), 0.0);
}

TEST(TrapezoidalProfile, SpeedAndAccelerationStayWithinTheirLimits) {
  for (const double distance : {0.3, 7.5, 300.0}) {
    const TrapezoidalProfile profile(distance, 30.0, 120.0);
    const double step = 1e-3;
    for (double t = -0.1; t < profile.Duration() + 0.1; t += step) {
      const double a = profile.At(t), b = profile.At(t + step), c = profile.At(t + 2 * step);
      EXPECT_GE(b, a);
      EXPECT_LE((b - a) / step, 30.0 * (1.0 + 1e-9));
      EXPECT_LE(std::abs(c - 2 * b + a) / (step * step), 120.0 * (1.0 + 1e-6)) << t;
    }
  }
}

TEST(MockTurntable, MovesAlongItsProfileAndAnyInstantCanBeAskedAgain) {
  TableBench bench(Rigid());
  bench.Start();
  const DeviceTime begin = bench.now;
  EXPECT_EQ(bench.Move(90.0).angle_deg, 90.0);
  const TrapezoidalProfile profile(90.0, 30.0, 120.0);
  for (int ms = 0; ms < 4000; ms += 7)
    EXPECT_NEAR(bench.table.TrueAngleDeg(begin + milliseconds(ms)), profile.At(1e-3 * ms), 1e-9);
  EXPECT_EQ(bench.True(), 90.0);
  EXPECT_NEAR(1e-9 * static_cast<double>((bench.arrived - begin).count()), profile.Duration(),
              2e-3);
  bench.Move(0.0);
  EXPECT_NEAR(bench.table.TrueAngleDeg(begin + milliseconds(1000)), profile.At(1.0), 1e-9);
  EXPECT_EQ(bench.table.CommandedAngleDeg(begin + milliseconds(1000)), 90.0);
  EXPECT_EQ(bench.table.CommandedAngleDeg(bench.now), 0.0);
}

TEST(MockTurntable, TruthIsContinuousOverMovesReversalsAndSwings) {
  MockTurntableConfig config;
  config.backlash_deg = 0.3;
  TableBench bench(config);
  bench.Start();
  const DeviceTime begin = bench.now;
  for (const double angle_deg : {10.0, 4.0, 4.1, 4.0, 30.0}) bench.Move(angle_deg);
  double previous = bench.table.TrueAngleDeg(begin);
  for (DeviceTime t = begin; t < bench.now; t += milliseconds(1)) {
    const double angle_deg = bench.table.TrueAngleDeg(t);
    EXPECT_LT(std::abs(angle_deg - previous), 0.04) << t.count();
    previous = angle_deg;
  }
}

TEST(MockTurntable, GoesInWholeSteps) {
  MockTurntableConfig config = Rigid();
  config.steps_per_deg = 3.0;
  TableBench bench(config);
  bench.Start();
  EXPECT_EQ(bench.Move(10.0).angle_deg, 10.0);
  EXPECT_EQ(bench.Move(10.1).angle_deg, 10.0);
  EXPECT_EQ(bench.Move(10.2).angle_deg, 31.0 / 3.0);
  EXPECT_EQ(bench.True(), 31.0 / 3.0);
  EXPECT_EQ(bench.table.CommandedAngleDeg(bench.now), 10.2);
}

TEST(MockTurntable, PlatterLagsByTheBacklashAfterAReversal) {
  MockTurntableConfig config = Rigid();
  config.backlash_deg = 0.5;
  TableBench bench(config);
  bench.Start();
  bench.Move(20.0);
  EXPECT_EQ(bench.True(), 20.0);
  EXPECT_EQ(bench.Move(19.7).angle_deg, 19.7);  // the report knows nothing of it
  EXPECT_EQ(bench.True(), 20.0);                // within the slack
  bench.Move(10.0);
  EXPECT_EQ(bench.True(), 10.5);
  bench.Move(10.2);
  EXPECT_EQ(bench.True(), 10.5);
  bench.Move(12.0);
  EXPECT_EQ(bench.True(), 12.0);
}

TEST(MockTurntable, HomingTakesUpTheBacklash) {
  MockTurntableConfig config = Rigid();
  config.backlash_deg = 5.0;
  TableBench bench(config);
  bench.Start();
  bench.Move(20.0);
  bench.Move(10.0);
  EXPECT_EQ(bench.True(), 15.0);
  const DeviceTime begin = bench.now;
  bench.Home();
  EXPECT_EQ(bench.True(), 0.0);
  // First the motor alone, 1.25 degrees in 0.1 s; the platter has not moved, but for whole turns.
  EXPECT_EQ(std::remainder(bench.table.TrueAngleDeg(begin + milliseconds(100)) - 15.0, 360.0), 0.0);
  EXPECT_NEAR(1e-9 * static_cast<double>((bench.arrived - begin).count()),
              TrapezoidalProfile(350.0, 60.0, 120.0).Duration(), 2e-3);
  bench.Move(10.0);
  EXPECT_EQ(bench.True(), 10.0);
}

TEST(MockTurntable, SwingsOnArrivalAndThenStandsExactly) {
  MockTurntableConfig config;
  config.settle_amplitude_deg = 0.05;
  config.settle_ms = 200.0;
  TableBench bench(config);
  bench.Start();
  bench.Move(30.0);
  double early = 0.0, late = 0.0;
  for (int ms = 1; ms < 200; ++ms) {
    const double off = std::abs(bench.table.TrueAngleDeg(bench.arrived + milliseconds(ms)) - 30.0);
    (ms < 100 ? early : late) = std::max(ms < 100 ? early : late, off);
  }
  EXPECT_GT(early, 0.02);
  EXPECT_LE(early, 0.05);
  EXPECT_LT(late, 0.5 * early);
  EXPECT_GT(late, 0.0);
  EXPECT_EQ(bench.table.TrueAngleDeg(bench.arrived + milliseconds(201)), 30.0);
}

TEST(MockTurntable, RestingAngleDependsOnTheStepsAlone) {
  MockTurntableConfig config;
  config.steps_per_deg = 88.8;
  TableBench straight(config), wandering(config);
  straight.Start();
  wandering.Start();
  straight.Move(70.0);
  for (const double angle_deg : {10.0, 333.3, 5.55, 12.0, 68.0, 70.0}) wandering.Move(angle_deg);
  EXPECT_EQ(straight.True(), wandering.True());
}

TEST(MockTurntable, IsUnhomedUntilItHasMetItsSwitch) {
  MockTurntableConfig config;
  config.power_on_deg = 100.0;
  config.home_switch_deg = 30.0;
  TableBench bench(config);
  EXPECT_FALSE(bench.table.State(bench.now));
  EXPECT_FALSE(bench.table.Home(bench.now));
  ASSERT_TRUE(bench.table.Open(bench.now));
  EXPECT_EQ(bench.State().motion, TableMotion::kUnhomed);
  const Status refused = bench.table.MoveTo(10.0, bench.now);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kDevice);
  EXPECT_THAT(refused.error().text, HasSubstr("home it first"));
  EXPECT_EQ(bench.True(), 100.0);
  const DeviceTime begin = bench.now;
  bench.Home();
  EXPECT_EQ(bench.State().motion, TableMotion::kIdle);
  EXPECT_EQ(bench.State().angle_deg, 30.0);
  EXPECT_EQ(bench.True(), 30.0);
  // 290 degrees in the positive direction; the truth jumps by whole turns only.
  EXPECT_NEAR(std::remainder(bench.table.TrueAngleDeg(begin + milliseconds(1)) - 100.0, 360.0), 0.0,
              0.01);
  EXPECT_NEAR(1e-9 * static_cast<double>((bench.arrived - begin).count()),
              TrapezoidalProfile(290.0, 60.0, 120.0).Duration(), 2e-3);
}

TEST(MockTurntable, RefusesToMoveWhileMovingAndOutOfRange) {
  TableBench bench;
  bench.Start();
  EXPECT_FALSE(bench.table.MoveTo(std::nan(""), bench.now));
  EXPECT_FALSE(bench.table.MoveTo(1e9, bench.now));
  ASSERT_TRUE(bench.table.MoveTo(90.0, bench.now));
  bench.now += milliseconds(500);
  EXPECT_EQ(bench.State().motion, TableMotion::kMoving);
  EXPECT_THAT(bench.table.MoveTo(10.0, bench.now).error().text, HasSubstr("moving already"));
  EXPECT_FALSE(bench.table.Home(bench.now));
  EXPECT_EQ(bench.Settle().angle_deg, 90.0);
}

TEST(MockTurntable, HaltStopsAtOnceAndOnlyAnEncoderKnowsWhere) {
  for (const TableFeedback feedback : {TableFeedback::kEncoder, TableFeedback::kOpenLoop}) {
    MockTurntableConfig config = Rigid();
    config.feedback = feedback;
    TableBench bench(config);
    bench.Start();
    const DeviceTime begin = bench.now;
    ASSERT_TRUE(bench.table.MoveTo(90.0, bench.now));
    bench.now += seconds(1);
    const double there = bench.True();
    ASSERT_TRUE(bench.table.Halt(bench.now));
    const TableState state = bench.Settle();
    EXPECT_NEAR(bench.True(), there, 1.0 / config.steps_per_deg);
    EXPECT_NEAR(bench.table.TrueAngleDeg(begin + milliseconds(500)), 11.25, 1e-6);
    if (feedback == TableFeedback::kEncoder) {
      EXPECT_EQ(state.motion, TableMotion::kIdle);
      EXPECT_EQ(state.angle_deg, bench.True());
      EXPECT_EQ(bench.Move(90.0).angle_deg, 90.0);
    } else {
      EXPECT_EQ(state.motion, TableMotion::kUnhomed);
      EXPECT_FALSE(bench.table.MoveTo(90.0, bench.now));
    }
  }
  TableBench idle;
  idle.Start();
  idle.Move(5.0);
  ASSERT_TRUE(idle.table.Halt(idle.now));
  EXPECT_EQ(idle.State().motion, TableMotion::kIdle);
}

TEST(MockTurntable, AWrongScaleIsInvisibleToTheController) {
  MockTurntableConfig config = Rigid();
  config.scale = -1.01;
  TableBench bench(config);
  bench.Start();
  EXPECT_EQ(bench.Move(100.0).angle_deg, 100.0);
  EXPECT_NEAR(bench.True(), -101.0, 1e-9);
  EXPECT_EQ(bench.Move(360.0).angle_deg, 360.0);
  EXPECT_NEAR(bench.True(), -363.6, 1e-9);
}

TEST(MockTurntable, LostStepsShowOnlyWithAnEncoderAndEndWithHoming) {
  TableBench encoder(Rigid(), {TableFaultAt(FaultKind::kLostSteps, 20.0)});
  encoder.Start();
  encoder.Move(10.0);
  EXPECT_EQ(encoder.True(), 10.0);
  EXPECT_EQ(encoder.Move(20.0).angle_deg, 19.0);
  EXPECT_EQ(encoder.True(), 19.0);
  EXPECT_EQ(encoder.Move(20.0).angle_deg, 20.0);  // the fault is spent
  EXPECT_EQ(encoder.True(), 20.0);

  TableBench open_loop(OpenLoop(), {TableFaultAt(FaultKind::kLostSteps, 20.0)});
  open_loop.Start();
  EXPECT_EQ(open_loop.Move(20.0).angle_deg, 20.0);
  EXPECT_EQ(open_loop.True(), 19.0);
  EXPECT_EQ(open_loop.Move(50.0).angle_deg, 50.0);
  EXPECT_EQ(open_loop.True(), 49.0);
  open_loop.Home();
  open_loop.Move(50.0);
  EXPECT_EQ(open_loop.True(), 50.0);
}

TEST(MockTurntable, AStallIsNoticedOnlyWithAnEncoder) {
  TableBench encoder(Rigid(), {TableFaultAt(FaultKind::kStall, 20.0)});
  encoder.Start();
  const TableState state = encoder.Move(20.0);
  EXPECT_EQ(state.motion, TableMotion::kUnhomed);
  EXPECT_THAT(state.fault, HasSubstr("stalled"));
  EXPECT_EQ(encoder.True(), 10.0);
  EXPECT_FALSE(encoder.table.MoveTo(20.0, encoder.now));
  encoder.Home();
  EXPECT_EQ(encoder.Move(20.0).angle_deg, 20.0);
  EXPECT_EQ(encoder.True(), 20.0);

  TableBench open_loop(OpenLoop(), {TableFaultAt(FaultKind::kStall, 20.0)});
  open_loop.Start();
  EXPECT_EQ(open_loop.Move(20.0).motion, TableMotion::kIdle);
  EXPECT_EQ(open_loop.State().angle_deg, 20.0);
  EXPECT_EQ(open_loop.True(), 10.0);
}

TEST(MockTurntable, ALateArrivalIsReportedAsMoving) {
  TableBench plain(Rigid()), late(Rigid(), {TableFaultAt(FaultKind::kLateArrival, 20.0)});
  for (TableBench* bench : {&plain, &late}) {
    bench->Start();
    bench->Move(20.0);
    EXPECT_EQ(bench->True(), 20.0);
  }
  EXPECT_EQ(late.arrived - plain.arrived, milliseconds(400));
  const DeviceTime hanging = plain.arrived + milliseconds(1);
  EXPECT_LT(late.table.TrueAngleDeg(hanging), 19.0);
}

TEST(MockTurntable, AWrongPositionIsReportedUntilTheNextMove) {
  TableBench bench(Rigid(), {TableFaultAt(FaultKind::kWrongPosition, 20.0)});
  bench.Start();
  EXPECT_EQ(bench.Move(20.0).angle_deg, 21.0);
  EXPECT_EQ(bench.True(), 20.0);
  EXPECT_EQ(bench.Move(20.0).angle_deg, 20.0);
}

TEST(MockTurntable, AlarmAndResetStopHalfWayUntilHomed) {
  for (const FaultKind kind : {FaultKind::kAlarm, FaultKind::kReset}) {
    TableBench bench(Rigid(), {TableFaultAt(kind, 20.0)});
    bench.Start();
    const TableState state = bench.Move(20.0);
    EXPECT_EQ(state.motion,
              kind == FaultKind::kAlarm ? TableMotion::kFault : TableMotion::kUnhomed);
    EXPECT_THAT(state.fault, HasSubstr(kind == FaultKind::kAlarm ? "ALARM" : "restarted"));
    EXPECT_EQ(bench.True(), 10.0);
    EXPECT_FALSE(bench.table.MoveTo(20.0, bench.now));
    bench.Home();
    EXPECT_EQ(bench.Move(20.0).motion, TableMotion::kIdle);
    EXPECT_EQ(bench.True(), 20.0);
  }
}

TEST(MockTurntable, AHomingThatNeverEndsCanBeHalted) {
  TableBench bench(Rigid(), {MakeFault(FaultKind::kNeverHomes)});
  ASSERT_TRUE(bench.table.Open(bench.now));
  ASSERT_TRUE(bench.table.Home(bench.now));
  bench.now += seconds(1000);
  EXPECT_EQ(bench.State().motion, TableMotion::kMoving);
  const double before = bench.True();
  bench.now += seconds(1);
  EXPECT_NEAR(bench.True() - before, 60.0, 1e-6);
  ASSERT_TRUE(bench.table.Halt(bench.now));
  EXPECT_EQ(bench.Settle().motion, TableMotion::kUnhomed);
  bench.Home();
  EXPECT_EQ(bench.State().motion, TableMotion::kIdle);
  EXPECT_EQ(bench.True(), 0.0);
}

TEST(MockTurntable, UnpluggedFailsUntilOpenedAgainAndIsUnhomedThen) {
  FaultEntry entry = MakeFault(FaultKind::kUnplugged);
  entry.from = seconds(60);
  TableBench bench(Rigid(), {entry});
  bench.Start();
  bench.Move(20.0);
  bench.now = seconds(60);
  const auto state = bench.table.State(bench.now);
  ASSERT_FALSE(state);
  EXPECT_EQ(state.error().kind, ErrorKind::kDevice);
  EXPECT_THAT(state.error().text, HasSubstr("MOCK-TABLE-1: unplugged"));
  EXPECT_FALSE(bench.table.Open(bench.now + milliseconds(499)));
  bench.now += milliseconds(500);
  EXPECT_THAT(bench.table.State(bench.now).error().text, HasSubstr("not open"));
  EXPECT_EQ(bench.table.Open(bench.now)->serial, "MOCK-TABLE-1");
  EXPECT_EQ(bench.State().motion, TableMotion::kUnhomed);
  bench.Home();
  bench.Move(20.0);
  EXPECT_EQ(bench.True(), 20.0);
}

TEST(MockTurntable, CreepsByItselfAndTheControllerKnows) {
  TableBench bench(Rigid());
  bench.Start();
  bench.Move(20.0);
  bench.table.Creep(0.5, bench.now + milliseconds(10), milliseconds(8));
  EXPECT_EQ(bench.State().motion, TableMotion::kIdle);
  bench.now += milliseconds(14);
  EXPECT_EQ(bench.State().motion, TableMotion::kMoving);
  EXPECT_NEAR(bench.True(), 20.25, 1e-6);
  EXPECT_EQ(bench.Settle().angle_deg, 20.5);
  EXPECT_EQ(bench.True(), 20.5);
  EXPECT_EQ(bench.table.CommandedAngleDeg(bench.now), 20.0);
  bench.Move(20.0);
  EXPECT_EQ(bench.True(), 20.0);
}

TEST(MockTurntable, TruthCanBeAskedWhileAnotherThreadMovesIt) {
  TableBench bench;
  bench.Start();
  const DeviceTime begin = bench.now;
  std::atomic<bool> done = false;
  int outside = 0;
  std::thread reader([&] {
    for (int i = 0; !done; ++i) {
      const double angle_deg = bench.table.TrueAngleDeg(begin + milliseconds(i % 20000));
      outside += !(angle_deg > -0.1 && angle_deg < 190.1);
    }
  });
  for (int i = 1; i < 20; ++i) bench.Move(10.0 * i);
  done = true;
  reader.join();
  EXPECT_EQ(outside, 0);
  EXPECT_EQ(bench.True(), 190.0);
}

}  // namespace
}  // namespace turnlight::rig::sim
