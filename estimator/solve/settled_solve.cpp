#include "estimator/solve/settled_solve.h"

#include <utility>

#include "estimator/solve/footprints.h"

namespace turnlight::estimator::solve {
namespace {

// Radians and 1/R: a shadow's edge moves by a small part of the pixel that is left out around it.
constexpr double kShadowTolerance = 2e-4;
// In a subsample edges are not left out; what its solves are for is coarser still.
constexpr double kSampleShadowTolerance = 5e-3;

}  // namespace

Solution SolveSettled(const observe::Observations& observations, const model::Scene& start,
                      SolveOptions options, int rounds, const Shadows& known) {
  const double tolerance = observations.subsampled ? kSampleShadowTolerance : kShadowTolerance;
  const int least = observations.subsampled ? 1 : 2;
  EvaluateOptions& evaluate = options.evaluate;
  evaluate.samples_per_side =
      FootprintSamples(observations, start.reflectance, least, evaluate.aperture);
  evaluate.shadows = CastShadows(observations, start, known, tolerance);
  Solution solution = Solve(observations, start, options);
  for (int round = 1; round < rounds; ++round) {
    auto samples =
        FootprintSamples(observations, solution.scene.reflectance, least, evaluate.aperture);
    Shadows shadows = CastShadows(observations, solution.scene, evaluate.shadows, tolerance);
    if (samples == evaluate.samples_per_side && SameShadows(shadows, evaluate.shadows)) break;
    evaluate.samples_per_side = std::move(samples);
    evaluate.shadows = std::move(shadows);
    Solution next = Solve(observations, solution.scene, options);
    next.iterations += solution.iterations;
    next.cost_history.erase(next.cost_history.begin());
    next.cost_history.insert(next.cost_history.begin(), solution.cost_history.begin(),
                             solution.cost_history.end());
    solution = std::move(next);
  }
  return solution;
}

}  // namespace turnlight::estimator::solve
