// One keyframe as the estimator takes it.
#pragma once

#include <opencv2/core.hpp>

#include "calib/pose.h"
#include "calib/radiometry.h"

namespace turnlight::estimator::model {

struct Keyframe {
  calib::LinearImage image;  // linear radiance, 1 or 3 channels, and the clipped pixels
  cv::Mat1b mask;            // non-zero = target
  calib::Pose X_WC;
  calib::Pose X_WT;
};

}  // namespace turnlight::estimator::model
