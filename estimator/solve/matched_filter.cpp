#include "estimator/solve/matched_filter.h"

#include <algorithm>

#include "estimator/model/direction_lattice.h"
#include "estimator/solve/footprints.h"
#include "estimator/solve/normal_equations.h"
#include "estimator/solve/prediction.h"

namespace turnlight::estimator::solve {
namespace {

constexpr int kDirections = 200;
constexpr double kNewDistance = 0.05;      // 1/R
constexpr double kShadowTolerance = 5e-3;  // radians, 1/R: a shadow may be that much out of date

}  // namespace

std::vector<MissingLight> RankMissingLights(const observe::Observations& pixels,
                                            const model::Scene& fitted, const Shadows& shadows) {
  const std::vector<Eigen::Vector3d> directions = model::SphereDirections(kDirections);
  // In batches of as many as a scene holds.
  const std::size_t known = fitted.lights.size();
  const std::size_t batch = model::kMaxLights - known;
  std::vector<MissingLight> gains;
  for (std::size_t begin = 0; begin < directions.size(); begin += batch) {
    model::Scene scene = fitted;
    const std::size_t end = std::min(directions.size(), begin + batch);
    for (std::size_t d = begin; d < end; ++d)
      scene.lights.push_back({directions[d], kNewDistance, 0.0, Eigen::Vector3d::Ones()});
    EvaluateOptions options;
    options.samples_per_side = FootprintSamples(pixels, scene.reflectance);
    options.shadows = CastShadows(pixels, scene, shadows, kShadowTolerance);
    const NormalEquations equations = Evaluate(pixels, scene, options);
    const model::Parameters parameters(scene, pixels.channels);
    for (std::size_t l = known; l < scene.lights.size(); ++l) {
      const int column = parameters.Intensity(static_cast<int>(l));
      const double slope = equations.gradient[column],
                   curvature = equations.hessian(column, column);
      if (!(slope < 0.0) || !(curvature > 0.0)) continue;
      MissingLight& gain = gains.emplace_back();
      gain.light = scene.lights[l];
      gain.light.intensity = -slope / curvature;
      gain.gain = 0.5 * slope * slope / curvature;
    }
  }
  std::stable_sort(gains.begin(), gains.end(),
                   [](const MissingLight& a, const MissingLight& b) { return a.gain > b.gain; });
  return gains;
}

std::optional<model::Light> MostMissingLight(const observe::Observations& pixels,
                                             const model::Scene& scene) {
  EvaluateOptions options;
  options.samples_per_side = FootprintSamples(pixels, scene.reflectance);
  options.shadows = CastShadows(pixels, scene);
  const auto model = Predict(pixels, scene, options);
  model::Scene alone = model::WithoutFactors(model::WithoutAmbient(scene));
  std::optional<model::Light> best;
  double most = 0.0;
  for (const Eigen::Vector3d& direction : model::SphereDirections(kDirections)) {
    alone.lights = {{direction, kNewDistance, 1.0, Eigen::Vector3d::Ones()}};
    options.shadows = CastShadows(pixels, alone, options.shadows);
    const auto change = Predict(pixels, alone, options);
    double slope = 0.0, curvature = 0.0;
    for (std::size_t c = 0; c < model.size(); ++c)
      for (std::size_t i = 0; i < pixels.size(); ++i) {
        if (pixels.pixel[i] == observe::Observations::kNoPixel) continue;
        const double weight = pixels.WeightOf(i);
        const double by = weight * static_cast<double>(change[c][i]);
        slope += by * weight *
                 (static_cast<double>(model[c][i]) - static_cast<double>(pixels.radiance[c][i]));
        curvature += by * by;
      }
    if (!(slope < 0.0) || !(slope * slope > most * curvature)) continue;
    most = slope * slope / curvature;
    best = alone.lights.front();
    best->intensity = -slope / curvature;
  }
  return best;
}

}  // namespace turnlight::estimator::solve
