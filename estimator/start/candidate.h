// A set of lights on a surface, fitted to the sample: what the search for a start compares.
#pragma once

#include <limits>
#include <vector>

#include "estimator/model/scene.h"
#include "estimator/solve/shadows.h"
#include "estimator/start/sample.h"

namespace turnlight::estimator::start {

struct Candidate {
  model::Scene scene;        // in the observations' coordinates
  solve::Shadows shadows;    // that it was fitted with
  double mean_square = 0.0;  // residual variance per value
  double excess = 0.0;       // of it what is above the noise, with a floor
  // How many times as large the excess is without the light that is missed the least; infinite if
  // that was not tried.
  double least_kept = std::numeric_limits<double>::infinity();
  std::vector<double> rms_history;  // on the sample: the start, and after each iteration since
};

// What a fit is for, as the solver's function tolerance: to be compared with others, which differ
// by factors, or to be gone on from.
inline constexpr double kToCompare = 2e-4, kToKeep = 1e-6;

// Fits the candidate's scene on from where it stands. noise: that the excess variance is above.
Candidate Refit(const Sample& sample, const Candidate& start, int iterations, double noise,
                double tolerance);

// Fits a start: strengths first, directions and distances held, and then everything.
Candidate FitStart(const Sample& sample, const model::Scene& start);

}  // namespace turnlight::estimator::start
