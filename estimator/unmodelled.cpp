#include "estimator/unmodelled.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "estimator/footprints.h"
#include "estimator/matched_filter.h"
#include "estimator/normal_errors.h"
#include "estimator/observation_access.h"
#include "estimator/prediction.h"
#include "estimator/sampling.h"
#include "estimator/tangent_basis.h"

namespace turnlight::estimator {
namespace {

constexpr std::size_t kPixels = 50000;
constexpr std::size_t kSearchPixels = 10000;
constexpr double kApertureStep = 0.05;
constexpr double kNearEdge = 2.0;     // half footprints
constexpr double kExtentStep = 0.08;  // of the lobe's half-width
constexpr double kWidestStep = 0.05;  // radians

void AddExtents(const Observations& pixels, const Scene& scene, const EvaluateOptions& options,
                const EffectProbe& probe, Unmodelled& out) {
  const double lobe = scene.reflectance.specular_model == SpecularModel::kNone
                          ? kWidestStep
                          : kExtentStep * LobeHalfWidth(scene.reflectance.shininess);
  const double step = std::min(lobe, kWidestStep);
  for (std::size_t l = 0; l < scene.lights.size(); ++l) {
    const Light& whole = scene.lights[l];
    const Eigen::Matrix<double, 3, 2> basis = TangentBasis(whole.direction);
    for (int k = 0; k < 3; ++k) {
      const double angle = k * std::numbers::pi / 3.0;
      const Eigen::Vector3d apart =
          step * (basis.col(0) * std::cos(angle) + basis.col(1) * std::sin(angle));
      // Two of half its intensity, to both sides.
      Scene split = scene;
      split.lights.push_back(whole);
      for (const std::size_t half : {l, split.lights.size() - 1}) {
        const double side = half == l ? 1.0 : -1.0;
        split.lights[half].direction = (whole.direction + side * apart).normalized();
        split.lights[half].intensity *= 0.5;
      }
      EvaluateOptions both = options;
      for (auto* planes : {&both.shadows.lit, &both.shadows.blocked})
        if (!planes->empty()) planes->push_back(Plane((*planes)[l]));
      Prediction change = Predict(pixels, split, both);
      AddTimes(-1.0, probe.model(), change);
      out.extents.push_back(probe.Of(change, 1.0 / (step * step)));
    }
  }
}

void AddLight(const Observations& pixels, const Scene& scene, EvaluateOptions options,
              const EffectProbe& probe, Unmodelled& out) {
  const auto light = MostMissingLight(EvenSubsample(pixels, kSearchPixels, 4, nullptr), scene);
  if (!light) return;
  Scene alone = scene;
  alone.reflectance.ambient = 0.0;
  alone.lights = {*light};
  alone.lights.front().intensity = 1.0;
  options.shadows = CastShadows(pixels, alone);
  out.light = probe.Of(Predict(pixels, alone, options), 1.0);
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

Eigen::VectorXd AveragedFalloff(const Observations& pixels, const Scene& scene,
                                EvaluateOptions options) {
  // An edge of a shadow is another matter.
  options.shadows.usable = AwayFromTerminators(pixels, scene.lights, kNearEdge);
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
  return EffectProbe(pixels, scene, options).Of(change, 1.0).mixed;
}

}  // namespace

Unmodelled TryUnmodelled(const Observations& observations, const Solution& solution) {
  // Edges of shadows are not in the fit.
  const Observations sample =
      EvenSubsample(observations, kPixels, 3, solution.evaluate.shadows.usable.get());
  const Scene& scene = solution.scene;
  EvaluateOptions options;
  options.huber = solution.evaluate.huber;
  options.samples_per_side = FootprintSamples(sample, scene.reflectance.shininess, 2);
  options.shadows = CastShadows(sample, scene);
  Unmodelled out;
  out.as_modelled = Evaluate(sample, scene, options);
  const EffectProbe probe(sample, scene, options);
  const TiltResponse tilts = TiltNormals(sample, scene, options, probe);
  out.tilts = tilts.effects;
  out.normal_variance = NormalVariance(sample, probe.model(), tilts.by_any);
  out.straightened = FitTilts(sample, solution, options, out.as_modelled, tilts);
  out.falloff = AveragedFalloff(sample, scene, options);
  EvaluateOptions wider = options, narrower = options;
  wider.aperture *= 1.0 + kApertureStep;
  narrower.aperture *= 1.0 - kApertureStep;
  Prediction change = Predict(sample, scene, wider);
  AddTimes(-1.0, Predict(sample, scene, narrower), change);
  out.aperture = probe.Of(change, 0.5 / kApertureStep);
  AddExtents(sample, scene, options, probe, out);
  AddLight(sample, scene, options, probe, out);
  return out;
}

}  // namespace turnlight::estimator
