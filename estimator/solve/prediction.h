// What the model says that the observations should show.
#pragma once

#include <vector>

#include "estimator/model/scene.h"
#include "estimator/observe/observations.h"
#include "estimator/solve/evaluate_options.h"

namespace turnlight::estimator::solve {

// Radiance of every observation, channel by channel, in the observations' order.
using Prediction = std::vector<std::vector<float>>;

// The model's radiances; those of filling have no meaning.
Prediction Predict(const observe::Observations& observations, const model::Scene& scene,
                   const EvaluateOptions& options);

}  // namespace turnlight::estimator::solve
