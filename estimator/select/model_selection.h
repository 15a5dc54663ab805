// Which model the data call for, from a good start on: loss, highlight or none, near or distant.
// Every decision is a rung of the ladder, with its numbers.
#pragma once

#include <vector>

#include "base/stop_flag.h"
#include "estimator/model/model_choice.h"
#include "estimator/model/rung.h"
#include "estimator/observe/observations.h"
#include "estimator/select/refined.h"

namespace turnlight::estimator::select {

// The full solve on all observations from a good start, its footprints sampled for the lobe found,
// Huber's loss where the residual is more than noise; then what is significant and relevant:
// specular (peak at least 0.003 of white and 3 sigma_stat), finite distances (about the reference:
// rho at least 3 sigma and rho R at least 5e-4); or as `choice` says. Returns the last solution
// with the options it was solved with. With stop set it returns soon, with what is of no use.
Refined Refine(const observe::Observations& observations, const model::Scene& start, double noise,
               double views_per_distinct, const model::ModelChoice& choice,
               std::vector<model::Rung>& ladder, const StopFlag* stop = nullptr);

}  // namespace turnlight::estimator::select
