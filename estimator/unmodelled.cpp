#include "estimator/unmodelled.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "estimator/missing_lights.h"
#include "estimator/normal_errors.h"
#include "estimator/observation_access.h"

namespace turnlight::estimator {
namespace {

constexpr std::size_t kPixels = 20000;
constexpr std::size_t kSearchPixels = 5000;
constexpr double kApertureStep = 0.05;
constexpr double kNearEdge = 2.0;     // half footprints
constexpr double kExtentStep = 0.15;  // of the lobe's half-width
constexpr double kWidestStep = 0.05;  // radians

// Of what cannot be negative.
Effect OneSided(const std::function<NormalEquations(double)>& at, const NormalEquations& zero,
                double step) {
  const NormalEquations one = at(step), two = at(2.0 * step);
  return {(4.0 * one.gradient - two.gradient - 3.0 * zero.gradient) / (2.0 * step),
          (4.0 * one.cost - two.cost - 3.0 * zero.cost) / (2.0 * step),
          (two.cost - 2.0 * one.cost + zero.cost) / (step * step)};
}

// The normal equations' cost and gradient by the scene's columns if one of its lights is two of
// half its intensity, `apart` to both sides along a tangent.
NormalEquations WithTwoHalves(const Observations& pixels, const Scene& scene, std::size_t light,
                              const Eigen::Vector3d& apart, EvaluateOptions options) {
  const Light& whole = scene.lights[light];
  Scene split = scene;
  split.lights.push_back(whole);
  for (const std::size_t half : {light, split.lights.size() - 1}) {
    const double side = half == light ? 1.0 : -1.0;
    split.lights[half].direction = (whole.direction + side * apart).normalized();
    split.lights[half].intensity *= 0.5;
  }
  for (auto* planes : {&options.shadows.lit, &options.shadows.blocked})
    if (!planes->empty()) planes->push_back(Plane((*planes)[light]));
  NormalEquations out = Evaluate(pixels, split, options);

  const int old_lights = static_cast<int>(scene.lights.size());
  const Columns columns{pixels.channels, old_lights};
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  double intensity = 0.0, rho = 0.0;
  for (const int half : {static_cast<int>(light), old_lights}) {
    turn += TangentBasis(split.lights[static_cast<std::size_t>(half)].direction) *
            out.gradient.segment<2>(columns.Tangent(half));
    intensity += 0.5 * out.gradient[columns.Intensity(half)];
    rho += out.gradient[columns.InverseDistance(half)];
  }
  out.gradient.conservativeResize(columns.count());
  const int l = static_cast<int>(light);
  out.gradient.segment<2>(columns.Tangent(l)) = TangentBasis(whole.direction).transpose() * turn;
  out.gradient[columns.Intensity(l)] = intensity;
  out.gradient[columns.InverseDistance(l)] = rho;
  return out;
}

void AddExtents(const Observations& pixels, const Scene& scene, const EvaluateOptions& options,
                Unmodelled& out) {
  const double lobe = scene.reflectance.specular_model == SpecularModel::kNone
                          ? kWidestStep
                          : kExtentStep * LobeHalfWidth(scene.reflectance.shininess);
  const double step = std::min(lobe, kWidestStep);
  for (std::size_t l = 0; l < scene.lights.size(); ++l) {
    const Eigen::Matrix<double, 3, 2> basis = TangentBasis(scene.lights[l].direction);
    for (int k = 0; k < 3; ++k) {
      const double angle = k * std::numbers::pi / 3.0;
      const Eigen::Vector3d axis = basis.col(0) * std::cos(angle) + basis.col(1) * std::sin(angle);
      out.extents.push_back(OneSided(
          [&](double variance) {
            return WithTwoHalves(pixels, scene, l, std::sqrt(variance) * axis, options);
          },
          out.as_modelled, step * step));
    }
  }
}

void AddLight(const Observations& pixels, const Scene& scene, EvaluateOptions options,
              Unmodelled& out) {
  const auto light = MostMissingLight(Subsample(pixels, kSearchPixels, 4), scene);
  if (!light) return;
  Scene more = scene;
  more.lights.push_back(*light);
  more.lights.back().intensity = 0.0;
  options.gradient_only = false;
  options.shadows = CastShadows(pixels, more, options.shadows, 0.0);
  const NormalEquations equations = Evaluate(pixels, more, options);
  const Columns columns{pixels.channels, static_cast<int>(scene.lights.size())};
  const int column = columns.Intensity(static_cast<int>(scene.lights.size()));
  out.light = Effect{equations.hessian.col(column).head(columns.count()),
                     equations.gradient[column], equations.hessian(column, column)};
}

// How the normal changes across a pixel: half as fast as what it mirrors.
Eigen::Vector3d NormalChange(const Observations& all, std::size_t first, std::size_t i) {
  const Eigen::Vector3d unit = At(all.normal, i).normalized(), dw = At(all.footprint, first, i);
  const double cosine = std::max(unit.dot(At(all.mirrored, i)), 0.05);
  return (dw - unit.dot(dw) * unit) / (2.0 * cosine);
}

// Positions and normals `by` pixels further along u (first 0) or v (first 3).
Observations Shifted(const Observations& all, std::size_t first, double by) {
  Observations out = all;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all.pixel[i] == Observations::kNoPixel) continue;
    Put(At(all.position, i) + by * At(all.step, first, i), i, out.position);
    Put(At(all.normal, i) + by * NormalChange(all, first, i), i, out.normal);
  }
  return out;
}

// Positions where the pixels' means are: on a bent surface below it. Of a pixel as wide as
// kAperture.
Observations Sunk(const Observations& all) {
  Observations out = all;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all.pixel[i] == Observations::kNoPixel) continue;
    double bend = 0.0;
    for (const std::size_t first : {0u, 3u})
      bend += At(all.step, first, i).dot(NormalChange(all, first, i));
    const double depth = kAperture * kAperture / 24.0 * bend;
    Put(At(all.position, i) - depth * At(all.normal, i), i, out.position);
  }
  return out;
}

using Prediction = std::vector<std::vector<float>>;

void AddTimes(double factor, const Prediction& what, Prediction& to) {
  for (std::size_t c = 0; c < to.size(); ++c)
    for (std::size_t i = 0; i < to[c].size(); ++i)
      to[c][i] += static_cast<float>(factor) * what[c][i];
}

Eigen::VectorXd AveragedFalloff(const Observations& pixels, const Scene& scene,
                                EvaluateOptions options) {
  // An edge of a shadow is another matter.
  options.shadows.usable = AwayFromTerminators(pixels, scene.lights, kNearEdge);
  const Eigen::VectorXd gradient = Evaluate(pixels, scene, options).gradient;
  Scene diffuse = scene;
  diffuse.reflectance.specular_model = SpecularModel::kNone;
  diffuse.reflectance.specular = 0.0;
  const auto predict = [&](const Observations& of) { return Predict(of, diffuse, options); };
  // f(h) + f(-h) - 2 f(0) = h^2 f'', and a mean over the width a is f + f'' a^2 / 24.
  const double h = kAperture / std::sqrt(12.0);
  Prediction change = predict(Sunk(pixels));
  for (const std::size_t first : {0u, 3u})
    for (const double side : {h, -h}) AddTimes(0.5, predict(Shifted(pixels, first, side)), change);
  AddTimes(-3.0, predict(pixels), change);
  Observations closer = pixels;
  for (std::size_t c = 0; c < change.size(); ++c)
    for (std::size_t i = 0; i < change[c].size(); ++i) closer.radiance[c][i] -= change[c][i];
  return Evaluate(closer, scene, options).gradient - gradient;
}

}  // namespace

Unmodelled TryUnmodelled(const Observations& observations, const Solution& solution) {
  const Observations sample = Subsample(observations, kPixels, 3);
  const Scene& scene = solution.scene;
  EvaluateOptions options;
  options.huber = solution.evaluate.huber;
  options.samples_per_side = FootprintSamples(sample, scene.reflectance.shininess);
  options.shadows = CastShadows(sample, scene);
  Unmodelled out;
  out.as_modelled = Evaluate(sample, scene, options);
  options.gradient_only = true;
  const TiltResponse tilts = TiltNormals(sample, scene, options, out.as_modelled);
  out.tilts = tilts.effects;
  out.normal_variance = NormalVariance(sample, Predict(sample, scene, options), tilts.by_any);
  out.straightened = FitTilts(sample, solution, options, out.as_modelled, tilts);
  out.falloff = AveragedFalloff(sample, scene, options);
  out.aperture = CentralEffect(
      [&](double by) {
        EvaluateOptions changed = options;
        changed.aperture *= 1.0 + by;
        return Evaluate(sample, scene, changed);
      },
      out.as_modelled, kApertureStep);
  AddExtents(sample, scene, options, out);
  AddLight(sample, scene, options, out);
  return out;
}

}  // namespace turnlight::estimator
