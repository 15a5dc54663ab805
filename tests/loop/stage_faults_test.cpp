// Proves, through real drivers, ports and nodes against simulated controllers: every frame is the
// scene at rest at its angle to within 5 sigma of its noise, whatever a serial line or a stage does
// of what docs/faults.md lists; what cannot be gone on with ends in time with its reason and with
// the motor standing. Built twice: through termios, and through libserialport. Does not prove:
// anything of a real controller, nor of an open loop that lost steps (process_test.cpp).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/loop/rig_loop.h"

namespace turnlight::loop {
namespace {

using rig::sim::FaultKind;
using testing::HasSubstr;

constexpr double kSigmas = 5.0;

void ExpectSurvived(const std::vector<RigLoopOptions>& all) {
  const std::vector<RigLoopRun> runs = RunAll(all);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    SCOPED_TRACE(rig::sim::FaultWord(all[i].faults.front().kind));
    const RigLoopRun& run = runs[i];
    const std::string lines = testing::PrintToString(run.lines);
    EXPECT_FALSE(run.report.failure) << run.report.failure->text << lines;
    EXPECT_EQ(run.faults_left, 0) << "the fault never struck";
    EXPECT_EQ(run.brackets.size(), 4u) << lines;
    EXPECT_LT(run.worst_sigmas, kSigmas) << lines;
  }
}

class StageLoop : public testing::TestWithParam<std::string> {
 protected:
  RigLoopOptions With(const rig::sim::FaultEntry& fault) const {
    RigLoopOptions options = SmallRigLoop(GetParam());
    options.faults = {fault};
    return options;
  }
};

TEST_P(StageLoop, EveryFrameIsTheStaticRenderAtItsAngle) {
  const RigLoopRun run = RunRigLoop(SmallRigLoop(GetParam()));
  ASSERT_FALSE(run.report.failure) << run.report.failure->text;
  EXPECT_THAT(run.opened, HasSubstr(TURNLIGHT_PORT_BACKEND));
  ASSERT_EQ(run.brackets.size(), 4u);
  EXPECT_LT(run.worst_sigmas, kSigmas);
  EXPECT_EQ(run.Rejected(), 0u) << testing::PrintToString(run.lines);
}

// What a capture survives by itself, with or without a repetition.
TEST_P(StageLoop, SurvivesWhatALineDoes) {
  std::vector<RigLoopOptions> all;
  for (const FaultKind kind :
       {FaultKind::kSerialGarbage, FaultKind::kSplitLine, FaultKind::kNulBytes,
        FaultKind::kLongLine, FaultKind::kDroppedReply, FaultKind::kDuplicateReply,
        FaultKind::kLateReply, FaultKind::kLostStatus, FaultKind::kAlteredStatus,
        FaultKind::kSilent})
    all.push_back(With(Fault(kind, 60.0)));
  ExpectSurvived(all);
}

TEST_P(StageLoop, SurvivesWhatAStageDoes) {
  std::vector<FaultKind> kinds{FaultKind::kUnplugged, FaultKind::kAlarm,
                               FaultKind::kReset,     FaultKind::kLateArrival,
                               FaultKind::kLimit,     FaultKind::kWrongPosition};
  // What only an encoder sees.
  if (GetParam() != "grbl")
    kinds.insert(kinds.end(), {FaultKind::kLostSteps, FaultKind::kStall, FaultKind::kDisplaced});
  std::vector<RigLoopOptions> all;
  for (const FaultKind kind : kinds) all.push_back(With(Fault(kind, 60.0)));
  // Of the first homing.
  for (const FaultKind kind : {FaultKind::kNeverHomes, FaultKind::kStuckSwitch}) {
    all.push_back(With(Fault(kind, std::nullopt)));
    all.back().turntable_params = "{poll_ms: 10, home_timeout_s: 3}";
  }
  ExpectSurvived(all);
}

// What does not go away by itself ends the capture, and what was good is kept.
TEST_P(StageLoop, WhatLastsEndsTheCaptureInTimeAndTheMotorStands) {
  std::vector<RigLoopOptions> all;
  for (const FaultKind kind : {FaultKind::kNeverHomes, FaultKind::kStuckSwitch})
    all.push_back(With(Fault(kind, std::nullopt, 1000)));
  for (const FaultKind kind : {FaultKind::kSilent, FaultKind::kUnplugged}) {
    all.push_back(With(Fault(kind, 60.0)));
    all.back().faults.front().amount = 1e7;  // ms
  }
  all.push_back(With(Fault(FaultKind::kAlarm, 60.0, 1000)));
  for (RigLoopOptions& options : all) {
    options.keyframes_params = "{retry_wait_ms: 200, lost_timeout_s: 3}";
    options.turntable_params = "{poll_ms: 10, home_timeout_s: 3}";
  }
  const std::vector<RigLoopRun> runs = RunAll(all);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    SCOPED_TRACE(rig::sim::FaultWord(all[i].faults.front().kind));
    const RigLoopRun& run = runs[i];
    const std::string lines = testing::PrintToString(run.lines);
    ASSERT_TRUE(run.report.failure) << lines;
    EXPECT_EQ(run.report.failure->code, "device") << lines;
    EXPECT_THAT(run.report.failure->text, HasSubstr("all good frames are kept"));
    const bool homing = !all[i].faults.front().angle_deg.has_value();
    EXPECT_EQ(run.brackets.size(), homing ? 0u : 2u) << lines;
    EXPECT_LT(run.worst_sigmas, kSigmas);
    EXPECT_FALSE(run.moving);
    EXPECT_LT(run.seconds_from_fault, 20.0) << lines;
  }
}

INSTANTIATE_TEST_SUITE_P(Firmwares, StageLoop, testing::Values("grbl", "zaber", "smc100"),
                         [](const auto& info) { return info.param; });

// The measure sees what the checks keep out.
TEST(StageLoopWithoutTheChecks, FramesAreFromTheWrongAngle) {
  std::vector<RigLoopOptions> all;
  for (const FaultKind kind : {FaultKind::kLostSteps, FaultKind::kStall, FaultKind::kAlarm}) {
    all.push_back(SmallRigLoop("zaber"));
    all.back().faults = {Fault(kind, 60.0)};
    all.back().check_arrival = all.back().settle = false;
  }
  for (const RigLoopRun& run : RunAll(all)) {
    EXPECT_EQ(run.faults_left, 0) << "the fault never struck";
    EXPECT_EQ(run.brackets.size(), 4u) << testing::PrintToString(run.lines);
    EXPECT_GT(run.worst_sigmas, 2.0 * kSigmas);
  }
}

}  // namespace
}  // namespace turnlight::loop
