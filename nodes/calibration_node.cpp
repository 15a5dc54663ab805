#include "nodes/calibration_node.h"

#include <vector>

#include "base/sha256.h"

namespace turnlight::nodes {

Status CalibrationNode::Start() {
  const std::string text = calibration_.camera.ToString();
  camera_sha256_ = Sha256Hex(text);
  camera_model_.Publish({text, camera_sha256_}, graph::Time(0));
  return {};
}

Status CalibrationNode::OnBracket(const graph::Message<Bracket>& bracket) {
  std::vector<rig::ExposedImage> exposures;
  for (const Frame& frame : bracket->exposures)
    exposures.push_back({frame.image, {frame.actual.exposure_us, frame.actual.gain_db}});
  auto merged = rig::MergeExposures(exposures, calibration_.raw, calibration_.noise);
  if (!merged) return Forward(merged);
  Keyframe keyframe;
  keyframe.bracket = *bracket;
  keyframe.camera_sha256 = camera_sha256_;
  keyframe.linear = calib::Linearise(merged->image, calibration_.session, merged->exposure);
  keyframe.image = merged->image;
  keyframe.validity = merged->validity;
  keyframe.exposure = merged->exposure;
  const calib::RigPoses placed =
      bracket->placed ? *bracket->placed
                      : calib::PosesAt(calibration_.geometry, bracket->angle_measured_deg);
  keyframe.X_WC = placed.X_WC;
  keyframe.X_WT = placed.X_WT;
  keyframe_.Publish(std::move(keyframe), bracket.header.valid_at);
  return {};
}

}  // namespace turnlight::nodes
