// All that is observed of a scene, checked to be enough for an estimate.
#pragma once

#include <cstddef>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "base/result.h"
#include "base/stop_flag.h"
#include "calib/camera_model.h"
#include "estimator/model/keyframe.h"
#include "estimator/model/keyframe_source.h"
#include "estimator/observe/observations.h"
#include "estimator/observe/usable.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::observe {

// Pixels that an estimate keeps when nothing else is asked for. With the rays of a camera of 24
// megapixels and two of its pictures that is less than 4 GB, whatever the target and the format.
inline constexpr std::size_t kMostPixels = 16'000'000;

struct ObserveOptions {
  std::size_t most_pixels = kMostPixels;  // of more, whole blocks are given up evenly
  const StopFlag* stop = nullptr;         // set: ends soon, with kInterrupted
  // Each keyframe once, in their order, while it is in memory. From the thread that observes.
  std::function<void(std::size_t keyframe, const model::Keyframe&)> on_keyframe;
};

struct ObservedScene {
  Observations pixels;
  std::size_t usable = 0;           // pixels, kept or not
  FlagCounts counts;                // of the target's pixels
  std::vector<cv::Mat> signatures;  // of the views, in white
};

// Reads each keyframe once, a few at a time. Fails as the source does, and with kNoEstimate, in
// words that say what to do, when nothing usable was observed: everything clipped, everything dark,
// nothing of the target in view, no surface. Deterministic for any number of threads.
Result<ObservedScene> ObserveScene(const model::KeyframeSource& keyframes,
                                   const target::Geometry& geometry, const calib::RayGrid& rays,
                                   const ObserveOptions& options = {});

}  // namespace turnlight::estimator::observe
