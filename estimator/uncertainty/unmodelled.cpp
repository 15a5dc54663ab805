#include "estimator/uncertainty/unmodelled.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "estimator/model/tangent_basis.h"
#include "estimator/observe/observation_access.h"
#include "estimator/observe/sampling.h"
#include "estimator/solve/footprints.h"
#include "estimator/solve/matched_filter.h"
#include "estimator/solve/prediction.h"
#include "estimator/uncertainty/normal_errors.h"

namespace turnlight::estimator::uncertainty {
namespace {

constexpr std::size_t kPixels = 50000;
constexpr std::size_t kSearchPixels = 10000;
constexpr double kApertureStep = 0.05;
constexpr double kNearTerminator = 2.0;  // half footprints
constexpr double kExtentStep = 0.08;     // of the lobe's half-width
constexpr double kWidestStep = 0.05;     // radians

void AddExtents(const observe::Observations& pixels, const model::Scene& scene,
                const solve::EvaluateOptions& options, const ScoreProbe& probe, Unmodelled& out) {
  const double lobe = scene.reflectance.lobes[0].model == model::SpecularModel::kNone
                          ? kWidestStep
                          : kExtentStep * model::LobeHalfWidth(scene.reflectance.lobes[0]);
  const double step = std::min(lobe, kWidestStep);
  for (std::size_t l = 0; l < scene.lights.size(); ++l) {
    const model::Light& whole = scene.lights[l];
    const Eigen::Matrix<double, 3, 2> basis = model::TangentBasis(whole.direction);
    std::array<Score, 3>& extents = out.extents.emplace_back();
    for (std::size_t axis = 0; axis < extents.size(); ++axis) {
      const double angle = ExtentAxis(axis);
      const Eigen::Vector3d apart =
          step * (basis.col(0) * std::cos(angle) + basis.col(1) * std::sin(angle));
      // Two of half its intensity, to both sides.
      model::Scene split = scene;
      split.lights.push_back(whole);
      for (const std::size_t half : {l, split.lights.size() - 1}) {
        const double side = half == l ? 1.0 : -1.0;
        split.lights[half].direction = (whole.direction + side * apart).normalized();
        split.lights[half].intensity *= 0.5;
      }
      solve::EvaluateOptions both = options;
      for (auto* masks : {&both.shadows.lit, &both.shadows.blocked})
        if (!masks->empty()) masks->push_back(solve::PixelMask((*masks)[l]));
      solve::Prediction change = solve::Predict(pixels, split, both);
      AddTimes(-1.0, probe.model(), change);
      extents[axis] = probe.Of(change, 1.0 / (step * step));
    }
  }
}

void AddLight(const observe::Observations& pixels, const model::Scene& scene,
              solve::EvaluateOptions options, const ScoreProbe& probe, Unmodelled& out) {
  const auto light = solve::MostMissingLight(
      observe::EvenSubsample(pixels, kSearchPixels, 4, nullptr, scene.flickers()), scene);
  if (!light) return;
  model::Scene alone = model::WithoutFactors(model::WithoutAmbient(scene));
  out.light_direction = light->direction;
  alone.lights = {*light};
  alone.lights.front().intensity = 1.0;
  options.shadows = solve::CastShadows(pixels, alone);
  out.light = probe.Of(solve::Predict(pixels, alone, options), 1.0);
}

// How the normal changes across a pixel: half as fast as what it mirrors.
Eigen::Vector3d NormalChange(const observe::Observations& all, std::size_t first, std::size_t i) {
  const Eigen::Vector3d unit = observe::At(all.normal, i).normalized(),
                        dw = observe::At(all.footprint, first, i);
  const double cosine = std::max(unit.dot(observe::At(all.mirrored, i)), 0.05);
  return (dw - unit.dot(dw) * unit) / (2.0 * cosine);
}

// Positions and normals `by` pixels further along u (first 0) or v (first 3).
observe::Observations Shifted(const observe::Observations& all, std::size_t first, double by) {
  observe::Observations out = all;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all.pixel[i] == observe::Observations::kNoPixel) continue;
    observe::Put(observe::At(all.position, i) + by * observe::At(all.step, first, i), i,
                 out.position);
    observe::Put(observe::At(all.normal, i) + by * NormalChange(all, first, i), i, out.normal);
  }
  return out;
}

// Positions where the pixels' means are: on a bent surface below it. Of a pixel as wide as
// kAperture.
observe::Observations Sunk(const observe::Observations& all) {
  observe::Observations out = all;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all.pixel[i] == observe::Observations::kNoPixel) continue;
    double bend = 0.0;
    for (const std::size_t first : {0u, 3u})
      bend += observe::At(all.step, first, i).dot(NormalChange(all, first, i));
    const double depth = observe::kAperture * observe::kAperture / 24.0 * bend;
    observe::Put(observe::At(all.position, i) - depth * observe::At(all.normal, i), i,
                 out.position);
  }
  return out;
}

Eigen::VectorXd AveragedFalloff(const observe::Observations& pixels, const model::Scene& scene,
                                solve::EvaluateOptions options) {
  // An edge of a shadow is another matter.
  options.shadows.usable = solve::AwayFromTerminators(pixels, scene.lights, kNearTerminator);
  model::Scene diffuse = scene;
  diffuse.reflectance.lobes.fill({});
  const auto predict = [&](const observe::Observations& of) {
    return solve::Predict(of, diffuse, options);
  };
  // f(h) + f(-h) - 2 f(0) = h^2 f'', and a mean over the width a is f + f'' a^2 / 24.
  const double h = observe::kAperture / std::sqrt(12.0);
  solve::Prediction change = predict(Sunk(pixels));
  for (const std::size_t first : {0u, 3u})
    for (const double side : {h, -h}) AddTimes(0.5, predict(Shifted(pixels, first, side)), change);
  AddTimes(-3.0, predict(pixels), change);
  return ScoreProbe(pixels, scene, options).Of(change, 1.0).cross_hessian;
}

}  // namespace

Unmodelled TryUnmodelled(const observe::Observations& observations,
                         const solve::Solution& solution) {
  // Edges of shadows are not in the fit.
  const observe::Observations sample = observe::EvenSubsample(
      observations, kPixels, 3, solution.evaluate.shadows.usable.get(), solution.scene.flickers());
  const model::Scene& scene = solution.scene;
  solve::EvaluateOptions options;
  options.huber = solution.evaluate.huber;
  options.samples_per_side = solve::FootprintSamples(sample, scene.reflectance, 2);
  options.shadows = solve::CastShadows(sample, scene);
  Unmodelled out;
  out.as_modelled = solve::Evaluate(sample, scene, options);
  const ScoreProbe probe(sample, scene, options);
  const TiltResponse tilts = TiltNormals(sample, scene, options, probe);
  out.tilts = tilts.scores;
  out.normal_variance = NormalVariance(sample, probe.model(), tilts.by_any);
  out.tilted_scene = FitTilts(sample, solution, options, out.as_modelled, tilts);
  out.falloff = AveragedFalloff(sample, scene, options);
  solve::EvaluateOptions wider = options, narrower = options;
  wider.aperture *= 1.0 + kApertureStep;
  narrower.aperture *= 1.0 - kApertureStep;
  solve::Prediction change = solve::Predict(sample, scene, wider);
  AddTimes(-1.0, solve::Predict(sample, scene, narrower), change);
  out.aperture = probe.Of(change, 0.5 / kApertureStep);
  AddExtents(sample, scene, options, probe, out);
  AddLight(sample, scene, options, probe, out);
  return out;
}

}  // namespace turnlight::estimator::uncertainty
