// What the model says that the observations should show.
#pragma once

#include <vector>

#include "estimator/evaluate_options.h"
#include "estimator/observations.h"
#include "estimator/scene.h"

namespace turnlight::estimator {

// Radiance of every observation, channel by channel, in the observations' order.
using Prediction = std::vector<std::vector<float>>;

// The model's radiances; 0 where an observation is not usable.
Prediction Predict(const Observations& observations, const Scene& scene,
                   const EvaluateOptions& options);

}  // namespace turnlight::estimator
