// What a fit found, in the form of every estimate: in W, in white, and in the gauge of the results.
#pragma once

#include "estimator/estimate.h"
#include "estimator/observe/observations.h"
#include "estimator/select/model_selection.h"

namespace turnlight::estimator {

// The root mean square of what a fit leaves.
void FillResidual(const observe::Observations& all, const select::Refined& refined, Estimate& out);

// Lights, reflectance, products, their sigmas and the residual; the decisions, notes, views and
// times are the caller's. calibration may be null.
void FillFromFit(const observe::Observations& observations, const select::Refined& refined,
                 Estimate& out, const uncertainty::CalibrationResponse* calibration = nullptr);

}  // namespace turnlight::estimator
