#include "nodes/estimator_node.h"

#include "base/angles.h"
#include "nodes/kept_keyframes.h"

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
  if (!judge_) return {};
  if (const Status status = TakeKept(); !status) return status;
  PublishVerdict(model.header.valid_at);
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
  const bool looked = Take({keyframe->linear, mask, keyframe->X_WC, keyframe->X_WT});
  if (looked && good_) PublishCurrent(keyframe.header.valid_at);
  return judge_ ? Judge(*keyframe, looked, keyframe.header.valid_at) : Status();
}

bool EstimatorNode::Take(const estimator::model::Keyframe& keyframe) {
  anytime_->Add(keyframe);
  if (anytime_->keyframes() % every_ != 0 && !(judge_ && judge_->NeedsEstimate())) return false;
  good_ = Step();
  return true;
}

bool EstimatorNode::Step() {
  if (const Status status = anytime_->Step(); !status) {
    ReportFault("no-estimate", status.error().text);
    return false;
  }
  for (const auto& [number, what] : anytime_->OddKeyframes())
    if (told_.insert(number).second)
      ReportFault("odd-keyframe", "keyframe " + std::to_string(number) + " " + what +
                                      "; it is left out of the estimates");
  return true;
}

const estimator::Estimate* EstimatorNode::Last() const {
  return good_ ? &*anytime_->Current() : nullptr;
}

// A log of a run that was resumed begins in the middle: nothing can be decided from it.
Status EstimatorNode::Judge(const Keyframe& keyframe, bool looked, graph::Time valid_at) {
  in_order_ = in_order_ && keyframe.bracket.index == judge_->taken();
  if (!in_order_) return {};
  judge_->Took(keyframe.bracket.angle_deg, keyframe.exposure, looked, Last());
  if (const Status status = TakeKept(); !status) return status;
  PublishVerdict(valid_at);
  return {};
}

Status EstimatorNode::TakeKept() {
  while (const rig::JournalEntry* entry = judge_->NextKept()) {
    const JudgeParts& parts = judge_->parts();
    const auto keyframe = ReadKept(parts.work->session, *entry, parts.sensor.radiometry);
    if (!keyframe) return Forward(keyframe);
    const bool looked = Take(*keyframe);
    judge_->Took(entry->frame.angle_deg.value_or(0.0), entry->frame.exposure, looked, Last());
  }
  return {};
}

void EstimatorNode::PublishVerdict(graph::Time valid_at) {
  verdict_.Publish(judge_->Decide(Last(), geometry_, *rays_), valid_at);
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
