// What a model leaves, as pictures.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "estimator/evaluate_options.h"
#include "estimator/observations.h"
#include "estimator/scene.h"

namespace turnlight::estimator {

// Per keyframe, grey observed minus model; NaN where nothing is used. scene is in the observations'
// coordinates; size: of the pictures.
std::vector<cv::Mat1f> ResidualMaps(const Observations& all, const Scene& scene,
                                    const EvaluateOptions& options, cv::Size size);

}  // namespace turnlight::estimator
