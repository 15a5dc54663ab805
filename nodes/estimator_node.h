// Estimates while the capture goes on. What it publishes is the best so far; the final answer is
// solved anew from the session.
//   in       camera_model  CameraModel
//   in       keyframe      Keyframe; the closure frame is not used
//   out      estimate      Estimate
//   params   every (1): solve after so many keyframes
//   faults   no-estimate: nothing usable yet; odd-keyframe: one that does not belong to the others
#pragma once

#include <optional>
#include <set>
#include <string>

#include "calib/camera_model.h"
#include "calib/target_shape.h"
#include "estimator/anytime.h"
#include "estimator/target/geometry.h"
#include "nodes/graph/node.h"
#include "nodes/messages.h"

namespace turnlight::nodes {

class EstimatorNode : public graph::Node {
 public:
  explicit EstimatorNode(const calib::TargetShape& target) : geometry_(target) {}
  Status Configure(StrictObject& params) override;

 private:
  Status OnCameraModel(const graph::Message<CameraModel>& model);
  Status OnKeyframe(const graph::Message<Keyframe>& keyframe);
  void PublishCurrent(graph::Time valid_at);

  graph::Input<CameraModel> camera_model_{this, "camera_model", &EstimatorNode::OnCameraModel};
  graph::Input<Keyframe> keyframe_{this, "keyframe", &EstimatorNode::OnKeyframe};
  graph::Output<Estimate> estimate_{this, "estimate"};
  std::uint64_t every_ = 1;
  std::uint64_t version_ = 0;
  std::string camera_sha256_;
  estimator::target::Geometry geometry_;
  std::optional<calib::RayGrid> rays_;
  std::optional<estimator::AnytimeEstimator> anytime_;
  std::set<std::size_t> told_;  // odd keyframes, each once
};

}  // namespace turnlight::nodes
