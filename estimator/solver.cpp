#include "estimator/solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "estimator/box_quadratic.h"

namespace turnlight::estimator {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Marquardt's damping, relative to the matrix's diagonal.
constexpr double kFirstDamping = 1e-4, kLeastDamping = 1e-9, kMostDamping = 1e8;
constexpr double kGaussNewton = 1e-2;  // below it a short step is the end, not the damping's doing
constexpr double kRounding = 1e-10;    // of the cost: what its sums in single precision resolve
// The linear model reaches no further than this in one step: radians, 1/R, log n, radians squared.
constexpr double kDirectionStep = 0.3, kDistanceStep = 0.1, kShininessStep = 1.0,
                 kRoughnessStep = 0.2;

std::size_t Strongest(const std::vector<Light>& lights) {
  const auto weaker = [](const Light& a, const Light& b) { return a.intensity < b.intensity; };
  return static_cast<std::size_t>(std::max_element(lights.begin(), lights.end(), weaker) -
                                  lights.begin());
}

// What the solver may do with one scalar.
struct Limits {
  bool held = false;
  double low = 0.0;
  double high = kInfinity;
  double step = kInfinity;  // the longest
};

std::vector<Limits> LimitsOf(const Columns& columns, const Scene& start,
                             const SolveOptions& options) {
  std::vector<Limits> limits(static_cast<std::size_t>(columns.count()));
  const auto at = [&](int column) -> Limits& { return limits[static_cast<std::size_t>(column)]; };
  int gauge_channel = 0;
  start.reflectance.albedo.head(columns.channels).maxCoeff(&gauge_channel);
  at(columns.Albedo(gauge_channel)).held = true;
  if (options.gauge == Gauge::kDiffuse) at(columns.Diffuse()).held = true;
  const bool specular = start.reflectance.specular_model != SpecularModel::kNone;
  at(columns.Specular()).held = !specular;
  at(columns.LogShininess()) = {!specular, std::log(kMinShininess), std::log(kMaxShininess),
                                kShininessStep};
  const bool rough = start.reflectance.diffuse_model == DiffuseModel::kOrenNayar;
  at(columns.RoughnessSquared()) = {!rough, 0.0, kMaxRoughness * kMaxRoughness, kRoughnessStep};
  for (int l = 0; l < columns.lights; ++l) {
    const auto index = static_cast<std::size_t>(l);
    const bool fixed = !options.fixed_distance.empty() && options.fixed_distance[index];
    at(columns.InverseDistance(l)) = {fixed, 0.0, kMaxInverseDistance, kDistanceStep};
    for (int k = 0; k < 2; ++k)
      at(columns.Tangent(l) + k) = {!options.free_directions, -kInfinity, kInfinity,
                                    kDirectionStep};
    at(columns.Intensity(l)).held =
        options.gauge == Gauge::kStrongestLight && index == Strongest(start.lights);
  }
  return limits;
}

// The value of each column; tangents are relative to the direction, so theirs are 0.
Eigen::VectorXd Values(const Scene& scene, const Columns& columns) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(columns.count());
  const Reflectance& r = scene.reflectance;
  for (int c = 0; c < columns.channels; ++c) out[columns.Albedo(c)] = r.albedo[c];
  out[columns.Ambient()] = r.ambient;
  out[columns.Diffuse()] = r.diffuse;
  out[columns.Specular()] = r.specular;
  out[columns.LogShininess()] = std::log(r.shininess);
  out[columns.RoughnessSquared()] = r.roughness * r.roughness;
  for (int l = 0; l < columns.lights; ++l) {
    const Light& light = scene.lights[static_cast<std::size_t>(l)];
    out[columns.Intensity(l)] = light.intensity;
    out[columns.InverseDistance(l)] = light.inverse_distance;
  }
  return out;
}

Scene WithinBounds(Scene scene) {
  Reflectance& r = scene.reflectance;
  r.albedo = r.albedo.cwiseMax(0.0);
  r.ambient = std::max(r.ambient, 0.0);
  r.diffuse = std::max(r.diffuse, 0.0);
  r.specular = std::max(r.specular, 0.0);
  r.shininess = std::clamp(r.shininess, kMinShininess, kMaxShininess);
  r.roughness = std::clamp(r.roughness, 0.0, kMaxRoughness);
  for (Light& light : scene.lights) {
    light.intensity = std::max(light.intensity, 0.0);
    light.inverse_distance = std::clamp(light.inverse_distance, 0.0, kMaxInverseDistance);
  }
  return scene;
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
    low[i] = scale[i] * std::min(std::max(limit.low - values[i], -limit.step), 0.0);
    high[i] = scale[i] * std::max(std::min(limit.high - values[i], limit.step), 0.0);
    if (scale[i] == 0.0) low[i] = high[i] = 0.0;
  }
  const Eigen::VectorXd inverse = scale.unaryExpr([](double s) { return s > 0.0 ? 1.0 / s : 0.0; });
  Eigen::MatrixXd scaled = inverse.asDiagonal() * equations.hessian * inverse.asDiagonal();
  scaled.diagonal() *= 1.0 + damping;
  const Eigen::VectorXd slope = inverse.asDiagonal() * equations.gradient;
  return inverse.asDiagonal() * MinimiseInBox(scaled, slope, low, high);
}

bool Finite(const NormalEquations& equations) {
  return std::isfinite(equations.cost) && equations.gradient.allFinite() &&
         equations.hessian.allFinite();
}

}  // namespace

Scene Moved(const Scene& scene, const Columns& columns, const Eigen::VectorXd& step) {
  Scene out = scene;
  Reflectance& r = out.reflectance;
  for (int c = 0; c < columns.channels; ++c) r.albedo[c] += step[columns.Albedo(c)];
  if (columns.channels == 1) r.albedo.setConstant(r.albedo[0]);
  r.ambient += step[columns.Ambient()];
  r.diffuse += step[columns.Diffuse()];
  r.specular += step[columns.Specular()];
  r.shininess *= std::exp(step[columns.LogShininess()]);
  const double squared = r.roughness * r.roughness + step[columns.RoughnessSquared()];
  if (step[columns.RoughnessSquared()] != 0.0) r.roughness = std::sqrt(std::max(squared, 0.0));
  for (int l = 0; l < columns.lights; ++l) {
    Light& light = out.lights[static_cast<std::size_t>(l)];
    light.intensity += step[columns.Intensity(l)];
    light.inverse_distance += step[columns.InverseDistance(l)];
    light.direction =
        (light.direction + TangentBasis(light.direction) * step.segment<2>(columns.Tangent(l)))
            .normalized();
  }
  return out;
}

Solution Solve(const Observations& observations, const Scene& start, const SolveOptions& options) {
  Solution out;
  out.scene = WithinBounds(start);
  out.evaluate = options.evaluate;
  const Columns columns{observations.channels, static_cast<int>(start.lights.size())};
  const std::vector<Limits> limits = LimitsOf(columns, out.scene, options);
  out.equations = Evaluate(observations, out.scene, options.evaluate);
  out.cost_history.push_back(out.equations.cost);
  double damping = kFirstDamping;
  while (Finite(out.equations) && out.iterations < options.max_iterations && !out.converged) {
    const double cost = out.equations.cost;
    const Eigen::VectorXd step =
        DampedStep(out.equations, Values(out.scene, columns), limits, damping);
    const double predicted =
        -step.dot(out.equations.gradient + 0.5 * (out.equations.hessian * step));
    if (!(predicted > kRounding * cost) || damping > kMostDamping) {
      // Nothing to gain: at the minimum, or (its step not finite) as close as it can be known.
      out.converged = true;
      break;
    }
    Scene trial = WithinBounds(Moved(out.scene, columns, step));
    NormalEquations equations = Evaluate(observations, trial, options.evaluate);
    ++out.iterations;
    const double gained = cost - equations.cost;
    if (!Finite(equations) || !(gained > 0.0)) {
      damping *= 10.0;
      out.cost_history.push_back(cost);
      // What it might gain is less than matters.
      out.converged = predicted <= options.function_tolerance * cost;
      continue;
    }
    out.converged = gained <= options.function_tolerance * cost && damping <= kGaussNewton;
    const double gain = gained / predicted;
    damping *= gain > 0.75 ? 0.1 : gain > 0.25 ? 0.5 : 4.0;
    damping = std::max(damping, kLeastDamping);
    out.scene = std::move(trial);
    out.equations = std::move(equations);
    out.cost_history.push_back(out.equations.cost);
  }
  for (const Limits& limit : limits) out.held.push_back(limit.held);
  return out;
}

Scene Normalised(const Scene& scene) {
  Scene out = scene;
  Reflectance& r = out.reflectance;
  const double albedo = r.albedo.maxCoeff();
  if (albedo > 0.0) {
    r.albedo /= albedo;
    r.ambient *= albedo;
    r.diffuse *= albedo;
  }
  std::stable_sort(out.lights.begin(), out.lights.end(),
                   [](const Light& a, const Light& b) { return a.intensity > b.intensity; });
  if (!out.lights.empty() && out.lights.front().intensity > 0.0) {
    const double strongest = out.lights.front().intensity;
    for (Light& light : out.lights) light.intensity /= strongest;
    r.diffuse *= strongest;
    r.specular *= strongest;
  }
  return out;
}

}  // namespace turnlight::estimator
