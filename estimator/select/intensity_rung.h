// Whether lights change from keyframe to keyframe.
#pragma once

#include <vector>

#include "estimator/model/model_choice.h"
#include "estimator/model/rung.h"
#include "estimator/select/refined.h"

namespace turnlight::estimator::select {

// Gives each light a factor in each keyframe (solve/frame_factors.h) if the pictures call for it:
// what the factors explain is beyond chance (4 sigma of chi squared), they vary by 0.3 % and 3
// sigma, and the variance that is left is 1.25 times smaller, or mere noise: factors can also
// stand for a surface that the model does not describe. Or as `choice` says.
void ChooseIntensities(const observe::Observations& observations, double noise,
                       const model::ModelChoice& choice, Refined& out,
                       std::vector<model::Rung>& ladder);

// Whether a rung is that decision.
bool IsOfIntensities(const model::Rung& rung);

}  // namespace turnlight::estimator::select
