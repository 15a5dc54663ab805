// What pixels and angles mean: merges the exposures of a bracket, turns DN into linear radiance,
// and says where camera and target were, unless the bracket does.
//   in       bracket       Bracket
//   out      camera_model  CameraModel, latched
//   out      keyframe      Keyframe; the closure frame as well
#pragma once

#include <utility>

#include "calib/camera_model.h"
#include "calib/radiometry.h"
#include "calib/rig_geometry.h"
#include "nodes/graph/node.h"
#include "nodes/messages.h"
#include "rig/capture/exposure_merge.h"

namespace turnlight::nodes {

struct BracketCalibration {
  calib::CameraModel camera;
  calib::Radiometry raw;      // of raw DN; with a reference exposure if brackets are merged
  calib::Radiometry session;  // rig::SessionRadiometry of it
  rig::SensorNoise noise;
  calib::RigGeometry geometry;
};

class CalibrationNode : public graph::Node {
 public:
  explicit CalibrationNode(BracketCalibration calibration) : calibration_(std::move(calibration)) {}
  Status Start() override;

 private:
  Status OnBracket(const graph::Message<Bracket>& bracket);

  graph::Input<Bracket> bracket_{this, "bracket", &CalibrationNode::OnBracket};
  graph::Output<CameraModel> camera_model_{this, "camera_model", graph::Latch::kYes};
  graph::Output<Keyframe> keyframe_{this, "keyframe"};
  BracketCalibration calibration_;
  std::string camera_sha256_;
};

}  // namespace turnlight::nodes
