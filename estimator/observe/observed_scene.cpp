#include "estimator/observe/observed_scene.h"

#include "estimator/observe/keyframe_tracer.h"
#include "estimator/observe/observations_builder.h"
#include "estimator/observe/views.h"

namespace turnlight::estimator::observe {

Result<ObservedScene> ObserveScene(const model::KeyframeSource& keyframes,
                                   const target::Geometry& geometry, const calib::RayGrid& rays,
                                   const ObserveOptions& options) {
  ObservedScene out;
  ObservationsBuilder builder(geometry, rays, keyframes.size(), options.most_pixels);
  const auto put = [&](std::size_t k, const model::Keyframe& keyframe, KeyframeTracer& tracer) {
    builder.Add(keyframe, tracer);
    out.counts = CountFlags({tracer.flags()}, out.counts);
    CountValues(keyframe, tracer.flags(), out.counts);
    out.counts.from_behind +=
        ShareFromBehind(keyframe, geometry, rays) / static_cast<double>(keyframes.size());
    out.signatures.push_back(ViewSignature(keyframe));
    if (options.on_keyframe) options.on_keyframe(k, keyframe);
  };
  if (const Status status = TraceKeyframes(keyframes, geometry, rays, options.stop, put); !status)
    return Forward(status);
  out.usable = builder.usable();
  out.pixels = builder.Finish();
  Complete(out.pixels);
  if (const Status status = CheckOutliers(out.counts); !status) return Forward(status);
  if (const Status status = CheckUsable(out.pixels, &out.counts); !status) return Forward(status);
  return out;
}

}  // namespace turnlight::estimator::observe
