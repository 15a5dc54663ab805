// All that is observed of a scene, checked to be enough for an estimate.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "base/result.h"
#include "calib/camera_model.h"
#include "estimator/model/keyframe.h"
#include "estimator/observe/observations.h"
#include "estimator/observe/usable.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::observe {

struct ObservedScene {
  Observations pixels;
  FlagCounts counts;                // of the target's pixels
  std::vector<cv::Mat> signatures;  // of the views
};

// Fails with kNoEstimate, in words that say what to do, when nothing usable was observed:
// everything clipped, everything dark, nothing of the target in view, no surface.
Result<ObservedScene> ObserveScene(const std::vector<model::Keyframe>& keyframes,
                                   const target::Geometry& geometry, const calib::RayGrid& rays);

}  // namespace turnlight::estimator::observe
