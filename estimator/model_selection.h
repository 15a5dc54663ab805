// Which model the data call for: how many lights, which reflectance, near or distant. Every
// decision is a rung of the ladder, with its numbers.
#pragma once

#include <string>
#include <vector>

#include "estimator/initial_values.h"
#include "estimator/observations.h"
#include "estimator/residual_splits.h"
#include "estimator/solver.h"

namespace turnlight::estimator {

struct Rung {  // one decision about the model, in the order they were taken
  std::string rung;
  bool accepted = false;
  std::string why;
};

// The start without a hint: the intensity map's clusters; if they and what they miss do not explain
// the pictures, also with Oren-Nayar, and an over-complete lattice of lights. Each is fitted and
// thinned out, and the best stays: a light more must make the excess variance three times smaller,
// Oren-Nayar 1.25 times.
Candidate FindLights(const Observations& sample, const std::vector<MapPoint>& clusters,
                     double noise, std::vector<Rung>& ladder);

// Lambert or Oren-Nayar for these lights, on the sample, by the same rule.
Candidate ChooseDiffuse(const Observations& sample, const Candidate& candidate, double noise,
                        std::vector<Rung>& ladder);

// The full solve on all observations from a good start, its footprints sampled for the lobe found,
// Huber's loss where the residual is more than noise; then what is significant and relevant:
// specular (peak at least 0.003 of white and 3 sigma_stat), finite distances (about the reference:
// rho at least 3 sigma and rho R at least 5e-4). Returns the last solution with the options it was
// solved with.
struct Refined {
  Solution solution;
  SolveOptions options;
  std::vector<bool> near;                // per light
  std::vector<double> inverse_distance;  // per light, about W's origin, with distances free
  std::vector<double> inverse_distance_sigma;
  double specular_sigma = 0.0;  // of k_s, if it was found not to matter
  std::vector<double> cost_history;
  int iterations = 0;
  ResidualSplits splits;  // of the solution
};
Refined Refine(const Observations& observations, const Scene& start, double noise,
               const SolveOptions& options, std::vector<Rung>& ladder);

}  // namespace turnlight::estimator
