// Proves, with all nodes of a capture on threads of their own and real time: the session is that of
// virtual time, byte for byte; a stop from another thread loses no frame, a stop now leaves the
// motor standing. Under the thread sanitizer: without a data race. Nothing here depends on how long
// something takes. Does not prove: that every order of the threads was met.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mock_rig.h"
#include "nodes/graph/log.h"
#include "tests/rig/capture/capture_fixture.h"

namespace turnlight::nodes {
namespace {

class WallCapture : public rig::CaptureFixture {
 protected:
  // A quick table, and little to wait for.
  MockRigOptions Options(const std::string& name, const std::string& executor) const {
    MockRigOptions options = WholeCapture(folder_.path() / name / "session");
    options.log = folder_.path() / (name + ".log");
    options.executor = executor;
    options.table.max_speed_deg_s = 1000.0;
    options.table.acceleration_deg_s2 = 10000.0;
    options.table.home_speed_deg_s = 1000.0;
    options.table.settle_ms = 10.0;
    options.plan.settle_ms = 20.0;
    options.plan.frame_timeout_s = 20.0;  // a loaded machine is no fault of the camera
    return options;
  }
};

TEST_F(WallCapture, GivesTheSessionOfVirtualTime) {
  const auto wall = Options("wall", "wall"), virtually = Options("virtual", "virtual");
  const MockRigRun run = RunMockRig(wall);
  ASSERT_FALSE(run.report.failure) << run.report.failure->text;
  EXPECT_TRUE(run.still_missing.empty());
  EXPECT_FALSE(run.estimates.empty());
  RunMockRig(virtually);
  EXPECT_EQ(Contents(wall.session), Contents(virtually.session));
}

// Asked from another thread, as a signal handler does, at some moment after the first keyframe.
class StoppedFromOutside : public WallCapture,
                           public testing::WithParamInterface<graph::StopMode> {};

TEST_P(StoppedFromOutside, LosesNoFrameAndLeavesTheMotorStanding) {
  const auto whole = Options("whole", "virtual");
  RunMockRig(whole);
  auto options = Options("stopped", "wall");
  options.stop_after_first = GetParam();
  const MockRigRun run = RunMockRig(options);
  EXPECT_EQ(run.report.cause, GetParam() == graph::StopMode::kDrain ? graph::StopCause::kRequested
                                                                    : graph::StopCause::kImmediate);
  EXPECT_TRUE(run.report.hung.empty());
  if (GetParam() == graph::StopMode::kDrain) {
    EXPECT_EQ(run.brackets.size() + run.still_missing.size(), 4u) << "a good frame was lost";
  }
  const auto state = run.table->State(run.report.ended_at);
  ASSERT_TRUE(state) << state.error().text;
  EXPECT_NE(state->motion, rig::TableMotion::kMoving);

  auto again = options;
  again.stop_after_first.reset();
  again.log = folder_.path() / "again.log";
  RunMockRig(again);
  EXPECT_EQ(Contents(whole.session), Contents(again.session));
}

INSTANTIATE_TEST_SUITE_P(Modes, StoppedFromOutside,
                         testing::Values(graph::StopMode::kDrain, graph::StopMode::kNow),
                         [](const auto& info) {
                           return info.param == graph::StopMode::kDrain ? "in_order" : "now";
                         });

}  // namespace
}  // namespace turnlight::nodes
