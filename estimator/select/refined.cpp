#include "estimator/select/refined.h"

#include <cmath>

#include "estimator/solve/settled_solve.h"

namespace turnlight::estimator::select {
namespace {

constexpr int kRounds = 3;  // of footprints and shadows

}  // namespace

double Rms(const observe::Observations& all, const solve::Solution& solution) {
  if (solution.evaluate.huber > 0.0) {
    // Its cost is of another loss. Factors are as they are.
    solve::EvaluateOptions squares = solution.evaluate;
    squares.huber = 0.0;
    squares.gradient_only = true;
    model::Scene scene = solution.scene;
    scene.free_factors = false;
    return std::sqrt(2.0 * solve::Evaluate(all, scene, squares).cost /
                     solve::ValueCount(all, squares));
  }
  return std::sqrt(2.0 * solution.equations.cost / solve::ValueCount(all, solution.evaluate));
}

void SolveOn(const observe::Observations& observations, Refined& out) {
  out.solution = solve::SolveSettled(observations, out.solution.scene, out.options, kRounds,
                                     out.solution.evaluate.shadows);
  out.options.evaluate = out.solution.evaluate;
  out.iterations += out.solution.iterations;
  // A solve begins where the last one ended.
  const std::vector<double>& costs = out.solution.cost_history;
  out.cost_history.insert(out.cost_history.end(),
                          costs.begin() + (out.cost_history.empty() ? 0 : 1), costs.end());
}

}  // namespace turnlight::estimator::select
