#include "estimator/observe/observed_scene.h"

#include "estimator/observe/views.h"

namespace turnlight::estimator::observe {

Result<ObservedScene> ObserveScene(const std::vector<model::Keyframe>& keyframes,
                                   const target::Geometry& geometry, const calib::RayGrid& rays) {
  ObservedScene out;
  std::vector<cv::Mat1b> flags;
  out.pixels = BuildObservations(keyframes, geometry, rays, &flags);
  out.counts = CountFlags(flags);
  for (std::size_t k = 0; k < keyframes.size(); ++k)
    CountValues(keyframes[k], flags[k], out.counts);
  if (!keyframes.empty())
    out.counts.from_behind = ShareFromBehind(keyframes.front(), geometry, rays);
  if (const Status status = CheckOutliers(out.counts); !status) return Forward(status);
  if (const Status status = CheckUsable(out.pixels, &out.counts); !status) return Forward(status);
  for (const model::Keyframe& keyframe : keyframes)
    out.signatures.push_back(ViewSignature(keyframe));
  return out;
}

}  // namespace turnlight::estimator::observe
