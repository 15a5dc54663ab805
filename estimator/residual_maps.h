// What a model leaves, as pictures.
#pragma once

#include <cstddef>
#include <map>
#include <opencv2/core.hpp>
#include <vector>

#include "estimator/model/scene.h"
#include "estimator/observe/observations.h"
#include "estimator/solve/evaluate_options.h"

namespace turnlight::estimator {

// Of these keyframes, grey observed minus model; NaN where nothing is used. scene is in the
// observations' coordinates; size: of the pictures.
std::map<std::size_t, cv::Mat1f> ResidualMaps(const observe::Observations& all,
                                              const model::Scene& scene,
                                              const solve::EvaluateOptions& options, cv::Size size,
                                              const std::vector<std::size_t>& keyframes);

}  // namespace turnlight::estimator
