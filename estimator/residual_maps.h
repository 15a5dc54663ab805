// What a model leaves, as pictures. Values are in white.
#pragma once

#include <cstddef>
#include <map>
#include <opencv2/core.hpp>
#include <vector>

#include "calib/camera_model.h"
#include "estimator/model/keyframe.h"
#include "estimator/model/scene.h"
#include "estimator/observe/observations.h"
#include "estimator/solve/evaluate_options.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator {

// Of these keyframes, grey observed minus model; NaN where nothing is used. scene is in the
// observations' coordinates and radiance unit; size: of the pictures.
std::map<std::size_t, cv::Mat1f> ResidualMaps(const observe::Observations& all,
                                              const model::Scene& scene,
                                              const solve::EvaluateOptions& options, cv::Size size,
                                              const std::vector<std::size_t>& keyframes);

// Whether a keyframe's rms, or any, is more than three times that of the median keyframe that shows
// something.
bool StandsOut(const std::vector<double>& rms, std::size_t keyframe);
bool OneStandsOut(const std::vector<double>& rms);

// Root mean square over a keyframe's pixels and channels; 0 where nothing is used.
std::vector<double> RmsByKeyframe(const observe::Observations& all, const model::Scene& scene,
                                  const solve::EvaluateOptions& options);

// The map of a keyframe that the scene (in W) was not estimated from.
cv::Mat1f ResidualMapOf(const model::Keyframe& keyframe, const target::Geometry& geometry,
                        const calib::RayGrid& rays, const model::Scene& scene);

}  // namespace turnlight::estimator
