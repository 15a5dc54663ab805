// Levenberg-Marquardt on the whole problem, within bounds: every step minimises the damped
// quadratic inside the box of what is allowed (see box_quadratic.h), instead of cutting a free step
// short. A step that ends at a bound is no failure then; with lights to spare most steps do.
#pragma once

#include <vector>

#include "base/stop_flag.h"
#include "estimator/solve/normal_equations.h"

namespace turnlight::estimator::solve {

// What is held to fix the scale between lights and reflectance.
enum class Gauge {
  kStrongestLight,  // the strongest light's intensity: good also where there is no diffuse part
  kDiffuse,         // k_d: good where it is open which lights will stay
};

struct SolveOptions {
  int max_iterations = 100;
  double function_tolerance = 1e-10;  // stop when a step lowers the cost by less than this share
  Gauge gauge = Gauge::kStrongestLight;
  bool free_directions = true;
  bool free_f0 = false;              // of physical lobes
  std::vector<bool> white;           // per light: its colour is held; of none: the strongest one's
  std::vector<bool> fixed_distance;  // per light, as above
  EvaluateOptions evaluate;
  const StopFlag* stop = nullptr;  // set: ends before the next iteration, as at its limit
};

// Why a solve ended.
enum class Stopped {
  kTolerance,       // a step would gain, or gained, less than the tolerance or than rounding
  kNoDescent,       // no step lowers the cost, however strongly it is damped
  kIterationLimit,  // max_iterations
  kNotFinite,       // the cost, its gradient or its matrix is not finite at the start
};

struct Solution {
  model::Scene scene;                // in the observations' coordinates
  NormalEquations equations;         // at the solution
  std::vector<double> cost_history;  // before the first and after each iteration
  std::vector<bool> held;            // per column: by the gauge, the model or the options
  int iterations = 0;
  Stopped stopped = Stopped::kIterationLimit;
  EvaluateOptions evaluate;  // what it was solved with
};

// Solves from a start in the observations' coordinates. The largest albedo, and what options.gauge
// names, keep the values they have in the start. Specular parameters are free unless the
// model is kNone, roughness if the model is kOrenNayar. Deterministic for any number of threads.
Solution Solve(const observe::Observations& observations, const model::Scene& start,
               const SolveOptions& options);

}  // namespace turnlight::estimator::solve
