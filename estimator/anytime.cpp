#include "estimator/anytime.h"

#include <utility>

#include "estimator/observe/views.h"

namespace turnlight::estimator {

void AnytimeEstimator::Add(const model::Keyframe& keyframe) {
  parts_.push_back(observe::BuildObservations({keyframe}, geometry_, rays_));
  signatures_.push_back(observe::ViewSignature(keyframe));
}

Status AnytimeEstimator::Step() {
  EstimateOptions options;
  const bool cold = !current_ || parts_.size() >= next_cold_;
  if (!cold) options.warm_start = current_->ToScene();
  auto estimate = EstimateObservations(observe::Concatenate(parts_), signatures_, options);
  if (!estimate) return Forward(estimate);
  if (cold) next_cold_ = 2 * parts_.size();
  current_ = std::move(*estimate);
  return {};
}

}  // namespace turnlight::estimator
