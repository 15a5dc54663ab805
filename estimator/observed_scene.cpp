#include "estimator/observed_scene.h"

#include "estimator/views.h"

namespace turnlight::estimator {

Result<ObservedScene> ObserveScene(const std::vector<Keyframe>& keyframes, const Geometry& geometry,
                                   const calib::RayGrid& rays) {
  ObservedScene out;
  std::vector<cv::Mat1b> flags;
  out.pixels = BuildObservations(keyframes, geometry, rays, &flags);
  out.counts = CountFlags(flags);
  if (const Status status = CheckOutliers(out.counts); !status) return Forward(status);
  if (const Status status = CheckUsable(out.pixels, &out.counts); !status) return Forward(status);
  for (const Keyframe& keyframe : keyframes) out.signatures.push_back(ViewSignature(keyframe));
  return out;
}

}  // namespace turnlight::estimator
