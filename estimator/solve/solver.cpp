#include "estimator/solve/solver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "estimator/solve/box_quadratic.h"
#include "estimator/solve/frame_factors.h"
#include "estimator/solve/unit_diagonal.h"

namespace turnlight::estimator::solve {
namespace {

// Marquardt's damping, relative to the matrix's diagonal.
constexpr double kFirstDamping = 1e-4, kLeastDamping = 1e-9, kMostDamping = 1e8;
constexpr double kGaussNewton = 1e-2;  // below it a short step is the end, not the damping's doing
constexpr double kRounding = 1e-10;    // of the cost: what its sums in single precision resolve

std::size_t Strongest(const std::vector<model::Light>& lights) {
  const auto weaker = [](const model::Light& a, const model::Light& b) {
    return model::Strength(a) < model::Strength(b);
  };
  return static_cast<std::size_t>(std::max_element(lights.begin(), lights.end(), weaker) -
                                  lights.begin());
}

// What the solver may do with one scalar.
struct Limits {
  bool held = false;
  model::ParameterLimits within;
};

// Whether one of the options' lists says so of a light; what a list has not it says not.
bool Says(const std::vector<bool>& list, std::size_t light) {
  return light < list.size() && list[light];
}

// Whether a parameter that the scene has is held: by the gauge, the models or the options.
bool Held(const model::Parameter& parameter, const model::Scene& start, int gauge_channel,
          const SolveOptions& options) {
  const auto largest = [](const Eigen::Vector3d& colour) {
    int channel = 0;
    colour.maxCoeff(&channel);
    return channel;
  };
  using enum model::ParameterKind;
  const auto owner = static_cast<std::size_t>(parameter.owner);
  const model::Reflectance& r = start.reflectance;
  switch (parameter.kind) {
    case kAlbedo:
      return parameter.owner == gauge_channel;
    case kDiffuse:
      return options.gauge == Gauge::kDiffuse;
    case kStrength:
    case kShape:
      return !r.lobes[owner].present();
    case kF0:
      return !options.free_f0;
    case kRoughness:
      return !model::FactsOf(r.diffuse_model).has_shape;
    case kIntensity:
      return options.gauge == Gauge::kStrongestLight && owner == Strongest(start.lights);
    case kTangent:
      return !options.free_directions;
    case kInverseDistance:
      return Says(options.fixed_distance, owner);
    case kColour:
      // One light's is the gauge, or that of all that have it; the others' have a strength beside
      // them.
      return (std::count(options.white.begin(), options.white.end(), true) > 0
                  ? Says(options.white, owner)
                  : owner == Strongest(start.lights)) ||
             parameter.part == largest(start.lights[owner].color);
    case kAmbientColour:
      return parameter.owner == largest(r.ambient_colour);
    case kSpecularColour:
      return parameter.owner == largest(r.specular_colour);
    case kAmbient:
    case kHarmonic:
    case kShading:
      break;
  }
  return false;
}

std::vector<Limits> LimitsOf(const model::Parameters& parameters, const model::Scene& start,
                             const SolveOptions& options) {
  int gauge_channel = 0;
  start.reflectance.albedo.head(parameters.channels()).maxCoeff(&gauge_channel);
  std::vector<Limits> limits;
  for (int i = 0; i < parameters.count(); ++i)
    limits.push_back({Held(parameters[i], start, gauge_channel, options),
                      model::LimitsOf(parameters[i], start)});
  return limits;
}

// Bounds of known distances go with the lights' directions.
void FollowDirections(const model::Parameters& parameters, const model::Scene& scene,
                      std::vector<Limits>& limits) {
  for (int l = 0; scene.distance.known() && l < parameters.lights(); ++l) {
    const int column = parameters.InverseDistance(l);
    limits[static_cast<std::size_t>(column)].within = model::LimitsOf(parameters[column], scene);
  }
}

// The step of the damped normal equations within the bounds, columns scaled to unit diagonal.
Eigen::VectorXd DampedStep(const NormalEquations& equations, const Eigen::VectorXd& values,
                           const std::vector<Limits>& limits, double damping) {
  const Eigen::Index n = values.size();
  Eigen::VectorXd scale = equations.hessian.diagonal().cwiseMax(0.0).cwiseSqrt();
  Eigen::VectorXd low(n), high(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Limits& limit = limits[static_cast<std::size_t>(i)];
    if (limit.held) scale[i] = 0.0;
    // Rounding must not put 0 outside.
    low[i] = scale[i] * std::min(std::max(limit.within.low - values[i], -limit.within.step), 0.0);
    high[i] = scale[i] * std::max(std::min(limit.within.high - values[i], limit.within.step), 0.0);
    if (scale[i] == 0.0) low[i] = high[i] = 0.0;
  }
  const Eigen::VectorXd inverse = InverseOrZero(scale);
  Eigen::MatrixXd scaled = inverse.asDiagonal() * equations.hessian * inverse.asDiagonal();
  scaled.diagonal() *= 1.0 + damping;
  const Eigen::VectorXd slope = inverse.asDiagonal() * equations.gradient;
  return inverse.asDiagonal() * MinimiseInBox(scaled, slope, low, high);
}

// Within the bounds, and with all that is unknown there.
model::Scene Prepared(const model::Scene& start, const observe::Observations& observations) {
  // What is held of a colour is its largest channel, which must not run away from solve to solve.
  model::Scene scene =
      model::WithinBounds(start.free_colours ? model::WithLargestColoursOne(start) : start);
  if (scene.free_factors) CompleteFactors(observations.tile_begin.size() - 1, scene);
  return scene;
}

// Of their own step factors take so much, less with damping as the other parameters do.
double ShareOf(double damping) { return 1.0 / (1.0 + damping); }

double PredictedGain(const NormalEquations& equations, const Eigen::VectorXd& step,
                     double damping) {
  const double share = ShareOf(damping);
  return -step.dot(equations.gradient + 0.5 * (equations.hessian * step)) +
         (equations.factors ? share * (2.0 - share) * equations.factors->gain : 0.0);
}

bool Finite(const NormalEquations& equations) {
  return std::isfinite(equations.cost) && equations.gradient.allFinite() &&
         equations.hessian.allFinite();
}

}  // namespace

Solution Solve(const observe::Observations& observations, const model::Scene& start,
               const SolveOptions& options) {
  Solution out;
  out.scene = Prepared(start, observations);
  out.evaluate = options.evaluate;
  const model::Parameters parameters(start, observations.channels);
  std::vector<Limits> limits = LimitsOf(parameters, out.scene, options);
  out.equations = Evaluate(observations, out.scene, options.evaluate);
  out.cost_history.push_back(out.equations.cost);
  double damping = kFirstDamping;
  bool done = false;
  if (!Finite(out.equations)) {
    out.stopped = Stopped::kNotFinite;
    done = true;
  }
  while (!done && out.iterations < options.max_iterations && !StopRequested(options.stop)) {
    const double cost = out.equations.cost;
    const Eigen::VectorXd step =
        DampedStep(out.equations, model::Values(out.scene, parameters), limits, damping);
    const double predicted = PredictedGain(out.equations, step, damping);
    if (!(predicted > kRounding * cost) || damping > kMostDamping) {
      // Nothing to gain: at the minimum, or (its step not finite) as close as it can be known.
      out.stopped = predicted <= kRounding * cost ? Stopped::kTolerance : Stopped::kNoDescent;
      break;
    }
    model::Scene trial = model::WithinBounds(model::Moved(out.scene, parameters, step));
    if (out.equations.factors) MoveFactors(*out.equations.factors, step, ShareOf(damping), trial);
    NormalEquations equations = Evaluate(observations, trial, options.evaluate);
    ++out.iterations;
    const double gained = cost - equations.cost;
    if (!Finite(equations) || !(gained > 0.0)) {
      damping *= 10.0;
      out.cost_history.push_back(cost);
      // What it might gain is less than matters.
      done = predicted <= options.function_tolerance * cost;
      continue;
    }
    done = gained <= options.function_tolerance * cost && damping <= kGaussNewton;
    const double gain = gained / predicted;
    damping *= gain > 0.75 ? 0.1 : gain > 0.25 ? 0.5 : 4.0;
    damping = std::max(damping, kLeastDamping);
    out.scene = std::move(trial);
    FollowDirections(parameters, out.scene, limits);
    out.equations = std::move(equations);
    out.cost_history.push_back(out.equations.cost);
  }
  if (done && out.stopped == Stopped::kIterationLimit) out.stopped = Stopped::kTolerance;
  for (const Limits& limit : limits) out.held.push_back(limit.held);
  return out;
}

}  // namespace turnlight::estimator::solve
