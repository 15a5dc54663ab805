// Which views tell something new.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "estimator/keyframe.h"

namespace turnlight::estimator {

// What distinguishes one view's picture from another's: every third row and column of it.
cv::Mat ViewSignature(const Keyframe& keyframe);

// Views whose pictures differ by more than noise (sigma of a value) from every earlier distinct one.
int DistinctViews(const std::vector<cv::Mat>& signatures, double noise);

}  // namespace turnlight::estimator
