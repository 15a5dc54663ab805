#include "estimator/start/candidate.h"

#include <cmath>
#include <utility>

#include "estimator/solve/coordinates.h"
#include "estimator/solve/settled_solve.h"

namespace turnlight::estimator::start {
namespace {

solve::Solution SolveStart(const Sample& sample, const Candidate& start, int iterations,
                           bool free_geometry, double tolerance) {
  solve::SolveOptions options;
  options.max_iterations = iterations;
  options.function_tolerance = tolerance;
  options.gauge = solve::Gauge::kDiffuse;
  options.free_directions = free_geometry;
  options.stop = sample.stop;
  const bool distant = sample.choice.near == false;
  if (!free_geometry || distant) options.fixed_distance.assign(start.scene.lights.size(), true);
  model::Scene scene = start.scene;
  scene.distance = solve::ToSolver(sample.choice.distance, sample.pixels);
  if (distant)
    for (model::Light& light : scene.lights) light.inverse_distance = 0.0;
  return solve::SolveSettled(sample.pixels, scene, options, 1, start.shadows);
}

// Appends a solve's costs, as root mean squares, to what went before.
void AppendHistory(const observe::Observations& pixels, const solve::Solution& solution,
                   std::vector<double>& history) {
  const double values = ValuesIn(pixels);
  for (std::size_t i = history.empty() ? 0 : 1; i < solution.cost_history.size(); ++i)
    history.push_back(std::sqrt(2.0 * solution.cost_history[i] / values));
}

}  // namespace

Candidate Refit(const Sample& sample, const Candidate& start, int iterations, double noise,
                double tolerance) {
  solve::Solution solution = SolveStart(sample, start, iterations, true, tolerance);
  const double mean_square = 2.0 * solution.equations.cost / ValuesIn(sample.pixels);
  Candidate out{std::move(solution.scene),
                std::move(solution.evaluate.shadows),
                mean_square,
                ExcessVariance(mean_square, noise),
                start.least_kept,
                start.rms_history};
  AppendHistory(sample.pixels, solution, out.rms_history);
  return out;
}

Candidate FitStart(const Sample& sample, const model::Scene& start) {
  Candidate best;
  best.scene = start;
  const solve::Solution linear = SolveStart(sample, best, 15, false, kToCompare);
  AppendHistory(sample.pixels, linear, best.rms_history);
  best.scene = linear.scene;
  best.shadows = linear.evaluate.shadows;
  return Refit(sample, best, 40, sample.noise, kToCompare);
}

}  // namespace turnlight::estimator::start
