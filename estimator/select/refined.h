// A fit on all observations, while it is decided what model the data call for.
#pragma once

#include <vector>

#include "estimator/observe/observations.h"
#include "estimator/solve/solver.h"
#include "estimator/uncertainty/residual_splits.h"

namespace turnlight::estimator::select {

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

inline constexpr double kMinInverseDistance = 5e-4;  // rho R: of a near light, at least
inline constexpr double kSignificance = 3.0;         // sigmas
inline constexpr double kChance = 4.0;       // sigmas of chi squared that chance does not reach
inline constexpr double kBeyondNoise = 2.0;  // residual rms over noise from which it is not noise

// Solves on from the scene and with the options of `out`; its splits are then out of date.
void SolveOn(const observe::Observations& observations, Refined& out);

// Root mean square of a solution's residuals.
double Rms(const observe::Observations& observations, const solve::Solution& solution);

}  // namespace turnlight::estimator::select
