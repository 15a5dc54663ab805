// Which model the data call for, from a good start on: loss, highlight or none, near or distant.
// Every decision is a rung of the ladder, with its numbers.
#pragma once

#include <vector>

#include "base/stop_flag.h"
#include "estimator/model/model_choice.h"
#include "estimator/model/rung.h"
#include "estimator/observe/observations.h"
#include "estimator/solve/solver.h"
#include "estimator/uncertainty/residual_splits.h"

namespace turnlight::estimator::select {

// The full solve on all observations from a good start, its footprints sampled for the lobe found,
// Huber's loss where the residual is more than noise; then what is significant and relevant:
// specular (peak at least 0.003 of white and 3 sigma_stat), finite distances (about the reference:
// rho at least 3 sigma and rho R at least 5e-4); or as `choice` says. Returns the last solution
// with the options it was solved with. With stop set it returns soon, with what is of no use.
struct Refined {
  solve::Solution solution;
  solve::SolveOptions options;
  double views_per_distinct = 1.0;       // covariances are as much larger: see EstimateUncertainty
  std::vector<bool> near;                // per light
  std::vector<double> inverse_distance;  // per light, about W's origin, with distances free
  std::vector<double> inverse_distance_sigma, inverse_distance_sigma_stat;
  // Of the strongest light's k_s I, if it was found not to matter.
  double specular_sigma = 0.0, specular_sigma_stat = 0.0;
  std::vector<double> cost_history;
  int iterations = 0;
  uncertainty::ResidualSplits splits;  // of the solution
};
Refined Refine(const observe::Observations& observations, const model::Scene& start, double noise,
               double views_per_distinct, const model::ModelChoice& choice,
               std::vector<model::Rung>& ladder, const StopFlag* stop = nullptr);

}  // namespace turnlight::estimator::select
