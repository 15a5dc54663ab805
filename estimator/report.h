// What a fit found, in the form of every estimate: in W and in the gauge of the results.
#pragma once

#include "estimator/estimate.h"
#include "estimator/model_selection.h"
#include "estimator/observations.h"

namespace turnlight::estimator {

// Lights, reflectance, products, their sigmas and the residual; the decisions, notes, views and
// times are the caller's.
void FillFromFit(const Observations& observations, const Refined& refined, Estimate& out);

}  // namespace turnlight::estimator
