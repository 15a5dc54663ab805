// Which views tell something new.
#pragma once

#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "estimator/model/keyframe.h"

namespace turnlight::estimator::observe {

// What distinguishes one view's picture from another's: every third row and column of it, fewer
// of a large one.
cv::Mat ViewSignature(const model::Keyframe& keyframe);

// The rms difference up to which two pictures are alike within noise (sigma of a value).
double LikeLimit(double noise);

// Views whose pictures are like an earlier one's, each with the first such view. limit: the rms
// difference of pictures that are alike.
std::vector<std::pair<int, int>> LikeViews(const std::vector<cv::Mat>& signatures, double limit);

// The number of the others: they differ from every earlier distinct one.
int DistinctViews(const std::vector<cv::Mat>& signatures, double limit);

}  // namespace turnlight::estimator::observe
