// Whether the ambient light comes from all sides alike.
#pragma once

#include <vector>

#include "estimator/model/model_choice.h"
#include "estimator/model/rung.h"
#include "estimator/select/refined.h"

namespace turnlight::estimator::select {

// Lets the ambient light depend on the normal (model/spherical_harmonics.h) if the pictures call
// for it: a score test of all harmonics together is beyond chance (4 sigma of chi squared), and,
// fitted, one of them is 3 sigma from 0 and they make at least 0.2 % of white; where more than
// noise is left they must also explain a fifth of it, for they can stand for a surface that the
// model lacks. A single view they must explain down to noise: there, a light's shading is nearly
// harmonics itself. Or as `choice` says. noise: sigma of a value.
void ChooseHarmonics(const observe::Observations& observations, double noise,
                     const model::ModelChoice& choice, Refined& out,
                     std::vector<model::Rung>& ladder);

// Whether a rung is that decision.
bool IsOfHarmonics(const model::Rung& rung);

}  // namespace turnlight::estimator::select
