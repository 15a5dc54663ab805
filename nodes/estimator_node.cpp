#include "nodes/estimator_node.h"

#include "base/angles.h"

namespace turnlight::nodes {

Status EstimatorNode::Configure(StrictObject& params) {
  every_ = static_cast<std::uint64_t>(params.OptionalInteger("every", 1, 100000).value_or(1));
  return {};
}

Status EstimatorNode::OnCameraModel(const graph::Message<CameraModel>& model) {
  const auto camera = calib::CameraModel::FromString(model->text, "camera_model");
  if (!camera) return Forward(camera);
  rays_.emplace(*camera);
  anytime_.emplace(geometry_, *rays_, *camera);
  camera_sha256_ = model->sha256;
  return {};
}

Status EstimatorNode::OnKeyframe(const graph::Message<Keyframe>& keyframe) {
  if (keyframe->bracket.closure) return {};
  if (!anytime_ || keyframe->camera_sha256 != camera_sha256_)
    return InputError("a keyframe of camera model " + keyframe->camera_sha256 + ", allowed is " +
                      (anytime_ ? camera_sha256_ : "none before a camera model"));
  const cv::Size size = keyframe->linear.radiance.size();
  if (size != cv::Size(rays_->width(), rays_->height()))
    return InputError("a keyframe of " + std::to_string(size.width) + " x " +
                      std::to_string(size.height) + " pixels, allowed is the camera model's " +
                      std::to_string(rays_->width()) + " x " + std::to_string(rays_->height()));
  const cv::Mat1b mask =
      keyframe->validity.empty() ? cv::Mat1b(size, std::uint8_t{255}) : keyframe->validity;
  anytime_->Add({keyframe->linear, mask, keyframe->X_WC, keyframe->X_WT});
  if (anytime_->keyframes() % every_ != 0) return {};
  if (const Status status = anytime_->Step(); !status) {
    ReportFault("no-estimate", status.error().text);
    return {};
  }
  for (const auto& [number, what] : anytime_->OddKeyframes())
    if (told_.insert(number).second)
      ReportFault("odd-keyframe", "keyframe " + std::to_string(number) + " " + what +
                                      "; it is left out of the estimates");
  PublishCurrent(keyframe.header.valid_at);
  return {};
}

void EstimatorNode::PublishCurrent(graph::Time valid_at) {
  const estimator::Estimate& current = *anytime_->Current();
  Estimate estimate{++version_, anytime_->keyframes(), {}, current.rms};
  for (const estimator::LightEstimate& light : current.lights)
    estimate.lights.push_back({light.light.direction, RadToDeg(light.direction_sigma),
                               light.light.inverse_distance, light.inverse_distance_sigma,
                               light.light.intensity, light.intensity_sigma.value_or(0.0)});
  estimate_.Publish(std::move(estimate), valid_at);
}

}  // namespace turnlight::nodes
