// Which views tell something new.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "estimator/model/keyframe.h"

namespace turnlight::estimator::observe {

// What distinguishes one view's picture from another's: every third row and column of it, fewer
// of a large one.
cv::Mat ViewSignature(const model::Keyframe& keyframe);

// Views whose pictures differ by more than noise (sigma of a value) from every earlier distinct
// one.
int DistinctViews(const std::vector<cv::Mat>& signatures, double noise);

}  // namespace turnlight::estimator::observe
