// Estimates while the capture goes on. What it publishes is the best so far; the final answer is
// solved anew from the session.
//   in       camera_model  CameraModel
//   in       keyframe      Keyframe; the closure frame is not used
//   out      estimate      Estimate
//   out      verdict       Verdict, if the plan has `until`: once at first, and after each
//   keyframe;
//                          what an earlier run has stored is taken in before
//   params   every (1): solve after so many keyframes; with `until` after the last planned one and
//            each further one, too
//   faults   no-estimate: nothing usable yet; odd-keyframe: one that does not belong to the others
#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>

#include "calib/camera_model.h"
#include "calib/target_shape.h"
#include "estimator/anytime.h"
#include "estimator/target/geometry.h"
#include "nodes/capture_judge.h"
#include "nodes/graph/node.h"
#include "nodes/messages.h"

namespace turnlight::nodes {

class EstimatorNode : public graph::Node {
 public:
  // judge: of a capture that goes on until the lights are known.
  explicit EstimatorNode(const calib::TargetShape& target,
                         std::optional<JudgeParts> judge = std::nullopt)
      : geometry_(target) {
    if (judge) judge_.emplace(std::move(*judge));
  }
  Status Configure(StrictObject& params) override;

 private:
  Status OnCameraModel(const graph::Message<CameraModel>& model);
  Status OnKeyframe(const graph::Message<Keyframe>& keyframe);
  // Takes a keyframe in; whether an estimate of all so far was asked for.
  bool Take(const estimator::model::Keyframe& keyframe);
  bool Step();
  const estimator::Estimate* Last() const;
  Status Judge(const Keyframe& keyframe, bool looked, graph::Time valid_at);
  Status TakeKept();
  void PublishVerdict(graph::Time valid_at);
  void PublishCurrent(graph::Time valid_at);

  graph::Input<CameraModel> camera_model_{this, "camera_model", &EstimatorNode::OnCameraModel};
  graph::Input<Keyframe> keyframe_{this, "keyframe", &EstimatorNode::OnKeyframe};
  graph::Output<Estimate> estimate_{this, "estimate"};
  graph::Output<Verdict> verdict_{this, "verdict"};
  std::uint64_t every_ = 1;
  std::uint64_t version_ = 0;
  std::string camera_sha256_;
  estimator::target::Geometry geometry_;
  std::optional<calib::RayGrid> rays_;
  std::optional<estimator::AnytimeEstimator> anytime_;
  std::set<std::size_t> told_;  // odd keyframes, each once
  std::optional<CaptureJudge> judge_;
  bool good_ = false;     // the last estimate that was asked for is there
  bool in_order_ = true;  // what comes is what the judge waits for
};

}  // namespace turnlight::nodes
