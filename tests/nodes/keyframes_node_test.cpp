// Proves, with simulated devices and scripted faults: a keyframe is published only if its picture
// is the scene at rest at its commanded angle, to within 5 sigma of its noise; with the checks of
// arrival and settling taken away the same test finds wrong frames; each fault ends as
// docs/faults.md says. Does not test drivers of real devices, nor faults that nothing can see in
// one run (an open loop that lost steps: the closure frame is for that).
#include "nodes/keyframes_node.h"

#include <gtest/gtest.h>

#include "mock_rig.h"

namespace turnlight::nodes {
namespace {

using rig::FaultKind;

// 64 x 48 x 3 normal values, 4 frames: the largest is beyond 5.2 sigma once in 140 draws, and the
// draw is the same every time.
constexpr double kSigmas = 5.2;

rig::FaultEntry At(FaultKind kind, double angle_deg) {
  rig::FaultEntry entry = rig::MakeFault(kind);
  entry.angle_deg = angle_deg;
  return entry;
}

TEST(KeyframesNode, EveryFrameIsTheStaticRenderAtItsAngle) {
  const MockRigRun run = RunMockRig(SmallCapture());
  EXPECT_FALSE(run.report.failure) << run.report.failure->text;
  ASSERT_EQ(run.brackets.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(run.brackets[i].index, i);
    EXPECT_NEAR(run.brackets[i].angle_measured_deg, 30.0 * static_cast<double>(i), 0.05);
    EXPECT_EQ(run.brackets[i].attempts, 1);
  }
  EXPECT_LT(run.Worst().max_sigmas, kSigmas);
}

TEST(KeyframesNode, WithoutTheChecksAFrameIsFromTheWrongAngle) {
  MockRigOptions options = SmallCapture();
  options.faults = {At(FaultKind::kLostSteps, 30.0), At(FaultKind::kStall, 60.0)};
  options.check_arrival = false;
  options.settle = false;
  const MockRigRun run = RunMockRig(options);
  EXPECT_GT(run.Worst().max_sigmas, 2.0 * kSigmas);
}

// What a capture survives by itself: the frame is taken again, and every frame is right. It strikes
// the fourth frame: a lamp that is off is known by the three before.
class SurvivedFault : public testing::TestWithParam<FaultKind> {};

TEST_P(SurvivedFault, IsRejectedAndRepeated) {
  MockRigOptions options = SmallCapture();
  options.faults = {At(GetParam(), 90.0)};
  const MockRigRun run = RunMockRig(options);
  ASSERT_FALSE(run.report.failure) << run.report.failure->text;
  EXPECT_EQ(run.faults->Remaining(), 0) << "the fault never struck";
  ASSERT_EQ(run.brackets.size(), 4u);
  EXPECT_LT(run.Worst().max_sigmas, kSigmas);
  EXPECT_GE(run.Rejected(), 1u);
  EXPECT_EQ(run.brackets[3].attempts, static_cast<int>(run.brackets[3].rejected.size()) + 1);
}

INSTANTIATE_TEST_SUITE_P(
    Faults, SurvivedFault,
    testing::Values(FaultKind::kLostSteps, FaultKind::kStall, FaultKind::kWrongPosition,
                    FaultKind::kAlarm, FaultKind::kReset, FaultKind::kUnplugged,
                    FaultKind::kStaleFrame, FaultKind::kDuplicateFrame, FaultKind::kDroppedFrame,
                    FaultKind::kIncompleteFrame, FaultKind::kBlurred, FaultKind::kTriggerIgnored,
                    FaultKind::kExposureDrift, FaultKind::kGainDrift, FaultKind::kLampOff,
                    FaultKind::kSaturated, FaultKind::kAllBlack, FaultKind::kControlLost),
    [](const auto& info) { return rig::FaultWord(info.param); });

// What needs no repetition, because the order of checks already deals with it.
class HarmlessFault : public testing::TestWithParam<FaultKind> {};

TEST_P(HarmlessFault, LeavesEveryFrameRight) {
  MockRigOptions options = SmallCapture();
  options.faults = {At(GetParam(), 30.0)};
  const MockRigRun run = RunMockRig(options);
  ASSERT_FALSE(run.report.failure) << run.report.failure->text;
  EXPECT_EQ(run.faults->Remaining(), 0) << "the fault never struck";
  ASSERT_EQ(run.brackets.size(), 4u);
  EXPECT_LT(run.Worst().max_sigmas, kSigmas);
}

INSTANTIATE_TEST_SUITE_P(Faults, HarmlessFault,
                         testing::Values(FaultKind::kLateArrival, FaultKind::kUntriggeredFrame),
                         [](const auto& info) { return rig::FaultWord(info.param); });

TEST(KeyframesNode, GivesUpAfterTheRetriesAndKeepsTheGoodFrames) {
  MockRigOptions options = SmallCapture();
  rig::FaultEntry black = At(FaultKind::kAllBlack, 60.0);
  black.times = 100;
  options.faults = {black};
  const MockRigRun run = RunMockRig(options);
  ASSERT_TRUE(run.report.failure);
  EXPECT_EQ(run.report.failure->code, "incomplete");
  EXPECT_NE(run.report.failure->text.find("frame 2 (60 deg), attempt 4 of 4"), std::string::npos)
      << run.report.failure->text;
  EXPECT_EQ(run.brackets.size(), 2u);
}

TEST(KeyframesNode, HomingThatNeverEndsIsADeviceFault) {
  MockRigOptions options = SmallCapture();
  rig::FaultEntry homing = rig::MakeFault(FaultKind::kNeverHomes);
  homing.times = 100;
  options.faults = {homing};
  const MockRigRun run = RunMockRig(options);
  ASSERT_TRUE(run.report.failure);
  EXPECT_EQ(run.report.failure->code, "device");
  EXPECT_NE(run.report.failure->text.find("homing did not end within 20 s"), std::string::npos)
      << run.report.failure->text;
  EXPECT_TRUE(run.brackets.empty());
}

}  // namespace
}  // namespace turnlight::nodes
