#include "estimator/model/keyframe_source.h"

namespace turnlight::estimator::model {

KeyframeSource SourceOf(const std::vector<Keyframe>& keyframes) {
  KeyframeSource out;
  for (const Keyframe& keyframe : keyframes) out.poses.push_back({keyframe.X_WC, keyframe.X_WT});
  out.read = [&keyframes](std::size_t k) -> Result<Keyframe> { return keyframes[k]; };
  return out;
}

}  // namespace turnlight::estimator::model
