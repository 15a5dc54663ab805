// What the paper's method found, in the form of every estimate.
#pragma once

#include "estimator/estimate.h"
#include "estimator/paper_method.h"

namespace turnlight::estimator {

// Lights, reflectance, residuals, decisions and notes; the views and times are the caller's. The
// gauge is the method's own: a light's intensity is (d0 / distance)^2, its irradiance at W's
// origin. Sigmas, bounds of distances and the condition are NaN or absent: the method has none.
void FillFromPaper(const Observations& observations, const PaperSolution& solution,
                   const PaperOptions& options, Estimate& out);

}  // namespace turnlight::estimator
