// Proves, with all nodes of a capture in one graph: what fails behind the keyframes node loses no
// good frame, the same config gives the same log byte for byte, a replay gives it again, and the
// closure frame arrives where it belongs. Does not test the program around the graph (tests/app).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "mock_rig.h"
#include "nodes/graph/log.h"
#include "rig/session/journal.h"
#include "static_render.h"
#include "tests/rig/capture/capture_fixture.h"

namespace turnlight::nodes {
namespace {

using rig::sim::FaultKind;
using testing::Contains;
using testing::HasSubstr;
namespace fs = std::filesystem;

class CaptureGraph : public rig::CaptureFixture {
 protected:
  // A capture into that folder, unless options say otherwise.
  MockRigOptions Options(const std::string& name) const {
    MockRigOptions options = WholeCapture(folder_.path() / name / "session");
    options.log = folder_.path() / (name + ".log");
    return options;
  }
  static void ExpectSameSession(const MockRigOptions& first, const MockRigOptions& second) {
    EXPECT_EQ(Contents(first.session), Contents(second.session));
  }
  // The first message that differs, in words.
  static std::string Difference(const MockRigOptions& first, const MockRigOptions& second,
                                graph::CompareMode mode = graph::CompareMode::kExact) {
    const auto difference = graph::CompareLogs(first.log, second.log, mode);
    if (!difference) return difference.error().text;
    return *difference ? (*difference)->text : "";
  }
};

TEST_F(CaptureGraph, SameConfigGivesTheSameLogAndSession) {
  const auto first = Options("first"), second = Options("second");
  const MockRigRun run = RunMockRig(first);
  ASSERT_FALSE(run.report.failure) << run.report.failure->text;
  EXPECT_TRUE(run.still_missing.empty());
  RunMockRig(second);
  EXPECT_EQ(ReadFile(first.log).value(), ReadFile(second.log).value());
  ExpectSameSession(first, second);
}

TEST_F(CaptureGraph, OtherNoiseIsNamedByItsFirstMessage) {
  const auto first = Options("first");
  auto second = Options("second");
  second.seed = 2;
  RunMockRig(first);
  RunMockRig(second);
  EXPECT_THAT(Difference(first, second), HasSubstr("keyframes.bracket"));
}

TEST_F(CaptureGraph, ReplayGivesTheSameLogAndSession) {
  auto first = Options("first"), second = Options("second");
  first.faults = {FaultAt(FaultKind::kLostSteps, 60.0)};
  RunMockRig(first);
  second.replay = first.log;
  const MockRigRun run = RunMockRig(second);
  ASSERT_FALSE(run.report.failure) << run.report.failure->text;
  EXPECT_EQ(Difference(first, second), "");
  ExpectSameSession(first, second);
}

// Every other keyframe one solution, from all keyframes so far, with error bars.
TEST_F(CaptureGraph, EstimatesComeWithVersionKeyframesAndSigma) {
  auto options = Options("all");
  options.estimator_params = "{every: 2}";
  const MockRigRun run = RunMockRig(options);
  ASSERT_EQ(run.estimates.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(run.estimates[i].version, i + 1);
    EXPECT_EQ(run.estimates[i].keyframes, 2 * (i + 1));
    ASSERT_FALSE(run.estimates[i].lights.empty());
    for (const LightNow& light : run.estimates[i].lights) {
      EXPECT_GT(light.direction_sigma_deg, 0.0);
      EXPECT_LT(light.direction_sigma_deg, 90.0);
    }
  }
}

TEST_F(CaptureGraph, ClosureFrameIsTakenAndStoredButNotEstimated) {
  auto options = Options("closed");
  options.plan.step_deg = 90.0;
  options.plan.closure = true;
  options.estimator_params = "{every: 1}";
  const MockRigRun run = RunMockRig(options);
  ASSERT_FALSE(run.report.failure) << run.report.failure->text;
  ASSERT_EQ(run.brackets.size(), 5u);
  const Bracket& closure = run.brackets.back();
  EXPECT_TRUE(closure.closure);
  EXPECT_EQ(closure.index, 4u);
  EXPECT_EQ(closure.angle_deg, 360.0);
  EXPECT_LT(WorstSigmas({closure}, run.camera->config()), 5.0);
  EXPECT_TRUE(fs::exists(options.session / "frames/closure.png"));
  EXPECT_TRUE(run.still_missing.empty());
  ASSERT_FALSE(run.estimates.empty());
  EXPECT_EQ(run.estimates.back().keyframes, 4u);
  const auto difference =
      rig::CompareFrames(run.brackets.front().exposures.front().image,
                         closure.exposures.front().image, run.camera->studio().radiometry);
  EXPECT_LT(difference.Sigmas(), 1.5);
}

// An open loop loses steps and nothing tells: the frames that follow are off, and the closure frame
// shows it.
TEST_F(CaptureGraph, ClosureFrameShowsStepsThatAnOpenLoopLost) {
  auto options = Options("lost");
  options.plan.step_deg = 90.0;
  options.plan.closure = true;
  options.table.feedback = rig::sim::TableFeedback::kOpenLoop;
  options.faults = {FaultAt(FaultKind::kLostSteps, 180.0)};
  const MockRigRun run = RunMockRig(options);
  ASSERT_FALSE(run.report.failure) << run.report.failure->text;
  ASSERT_EQ(run.brackets.size(), 5u);
  const auto difference = rig::CompareFrames(run.brackets.front().exposures.front().image,
                                             run.brackets.back().exposures.front().image,
                                             run.camera->studio().radiometry);
  EXPECT_GT(difference.Sigmas(), 3.0);
}

// The disk fills up, or fails, in the middle of the capture.
class FailingDisk : public CaptureGraph,
                    public testing::WithParamInterface<rig::FaultyOps::Fault> {};

TEST_P(FailingDisk, PausesWithEveryGoodFrameAndResumesToTheSameBytes) {
  const auto whole = Options("whole");
  auto broken = Options("broken");
  rig::FaultyOps counter;
  auto counted = whole;
  counted.disk = &counter;
  RunMockRig(counted);
  rig::FaultyOps disk(GetParam(), counter.calls() * 2 / 3);
  broken.disk = &disk;
  const MockRigRun run = RunMockRig(broken);
  ASSERT_TRUE(run.report.failure);
  EXPECT_EQ(run.report.failure->node, "recorder");
  EXPECT_THAT(run.lines, Contains(HasSubstr("recorder: ")));
  const std::size_t missing = run.still_missing.size();
  EXPECT_GE(missing, 1u);
  EXPECT_LT(missing, 4u) << "nothing was kept";

  auto again = broken;
  again.disk = &SystemFileOps();
  again.log = folder_.path() / "again.log";
  const MockRigRun rest = RunMockRig(again);
  ASSERT_FALSE(rest.report.failure) << rest.report.failure->text;
  EXPECT_EQ(rest.brackets.size(), missing) << "good frames were taken again";
  ExpectSameSession(whole, again);
}

INSTANTIATE_TEST_SUITE_P(Faults, FailingDisk,
                         testing::Values(rig::FaultyOps::Fault::kNoSpace,
                                         rig::FaultyOps::Fault::kError),
                         [](const auto& info) {
                           return info.param == rig::FaultyOps::Fault::kNoSpace ? "full" : "broken";
                         });

TEST_F(CaptureGraph, AnEstimatorWithoutAnEstimateStopsNothing) {
  auto options = Options("dark");
  options.gate.min_bright_level = 0.0;  // lets black pictures through
  options.faults = {FaultAt(FaultKind::kAllBlack, std::nullopt, 100)};
  const MockRigRun run = RunMockRig(options);
  ASSERT_FALSE(run.report.failure) << run.report.failure->text;
  EXPECT_TRUE(run.estimates.empty());
  EXPECT_TRUE(run.still_missing.empty());
  EXPECT_THAT(run.lines, Contains(HasSubstr("estimator: no-estimate: ")));
}

// The estimator is busy for 5 s at a time, longer than a keyframe takes. Where its input may drop,
// it drops and counts; the recorder, behind a connection that blocks, gets every frame.
TEST_F(CaptureGraph, ASlowEstimatorDropsWhatItMayAndTheCountIsRight) {
  auto options = Options("slow");
  options.plan.count = 12;
  options.to_estimator = "policy: {keep_last: 1}";
  options.estimator_params = "{every: 1}";
  const MockRigRun run = RunMockRig(options);
  ASSERT_FALSE(run.report.failure) << run.report.failure->text;
  EXPECT_TRUE(run.still_missing.empty());
  const auto& to_estimator = run.Connection("calibration.keyframe", "estimator.keyframe");
  EXPECT_GT(to_estimator.dropped, 0u);
  EXPECT_EQ(to_estimator.delivered, 12u);
  ASSERT_FALSE(run.estimates.empty());
  EXPECT_EQ(run.estimates.back().keyframes, 12u - to_estimator.dropped);
  EXPECT_EQ(run.Connection("calibration.keyframe", "recorder.keyframe").dropped, 0u);
}

// Calls go to the simulated camera until one of them, counted from 1, does something else.
class OddCamera : public rig::Camera {
 public:
  OddCamera(std::shared_ptr<rig::Camera> camera, int odd_trigger,
            std::function<Result<std::uint64_t>()> odd)
      : camera_(std::move(camera)), odd_trigger_(odd_trigger), odd_(std::move(odd)) {}
  Result<rig::DeviceIdentity> Open(rig::DeviceTime now) override { return camera_->Open(now); }
  Result<rig::CameraSettings> Set(const rig::CameraSettings& settings,
                                  rig::DeviceTime now) override {
    return camera_->Set(settings, now);
  }
  Result<int> Drain(rig::DeviceTime now) override { return camera_->Drain(now); }
  Result<std::uint64_t> Trigger(rig::DeviceTime now) override {
    return ++triggers_ == odd_trigger_ ? odd_() : camera_->Trigger(now);
  }
  Result<std::optional<rig::RawFrame>> Poll(rig::DeviceTime now) override {
    return camera_->Poll(now);
  }

 private:
  std::shared_ptr<rig::Camera> camera_;
  int odd_trigger_;
  std::function<Result<std::uint64_t>()> odd_;
  int triggers_ = 0;
};

TEST_F(CaptureGraph, AnExceptionInADriverStopsInOrderAndKeepsTheFrames) {
  auto options = Options("thrown");
  options.wrap_camera = [](std::shared_ptr<rig::Camera> camera) {
    return std::make_shared<OddCamera>(std::move(camera), 3, []() -> Result<std::uint64_t> {
      throw std::runtime_error("a driver's bug");
    });
  };
  const MockRigRun run = RunMockRig(options);
  ASSERT_TRUE(run.report.failure);
  EXPECT_EQ(run.report.failure->node, "camera");
  EXPECT_THAT(run.report.failure->text, HasSubstr("a driver's bug"));
  EXPECT_EQ(run.still_missing.size(), 2u);
  EXPECT_EQ(rig::ReadJournal(options.session)->entries.size(), 2u);
}

// Ctrl-C once, when the second keyframe was taken and the third is about to begin.
TEST_F(CaptureGraph, AStopInOrderFinishesTheKeyframeAndKeepsAll) {
  const auto whole = Options("whole");
  RunMockRig(whole);
  auto options = Options("stopped");
  options.before_run = [](graph::Graph& graph) {
    const Status tapped =
        graph.Tap<Bracket>("keyframes.bracket", [&graph](const graph::Message<Bracket>& bracket) {
          if (bracket->index == 1) graph.RequestStop(graph::StopMode::kDrain);
        });
    ASSERT_TRUE(tapped) << tapped.error().text;
  };
  const MockRigRun run = RunMockRig(options);
  EXPECT_EQ(run.report.cause, graph::StopCause::kRequested);
  EXPECT_LT(run.brackets.size(), 4u);
  EXPECT_EQ(run.brackets.size() + run.still_missing.size(), 4u) << "a good frame was lost";

  auto again = options;
  again.before_run = nullptr;
  again.log = folder_.path() / "again.log";
  RunMockRig(again);
  ExpectSameSession(whole, again);
}

}  // namespace
}  // namespace turnlight::nodes
