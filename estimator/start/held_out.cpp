#include "estimator/start/held_out.h"

#include <algorithm>

#include "base/format.h"
#include "estimator/solve/footprints.h"
#include "estimator/solve/prediction.h"
#include "estimator/start/eliminate_lights.h"
#include "estimator/start/score.h"

namespace turnlight::estimator::start {
namespace {

constexpr double kLeastShare = 0.002;  // of all light

struct Fit {
  solve::Prediction model;
  double square = 0.0;  // sum of squared residuals
  double sum = 0.0;     // of the model's radiance
};

Fit Explain(const observe::Observations& pixels, const model::Scene& scene) {
  solve::EvaluateOptions options;
  options.samples_per_side = solve::FootprintSamples(pixels, scene.reflectance);
  options.shadows = solve::CastShadows(pixels, scene);
  Fit fit{solve::Predict(pixels, scene, options), 0.0, 0.0};
  for (int c = 0; c < pixels.channels; ++c)
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      if (pixels.pixel[i] == observe::Observations::kNoPixel) continue;
      const auto model = static_cast<double>(fit.model[static_cast<std::size_t>(c)][i]);
      const double residual =
          pixels.WeightOf(i) * (model - static_cast<double>(pixels.radiance[c][i]));
      fit.square += residual * residual;
      fit.sum += model;
    }
  return fit;
}

model::Scene Without(model::Scene scene, std::size_t light) {
  scene.lights.erase(scene.lights.begin() + static_cast<std::ptrdiff_t>(light));
  return scene;
}

}  // namespace

Candidate CheckHeldOut(const observe::Observations& held_out, const Sample& sample,
                       Candidate candidate, std::vector<model::Rung>& ladder) {
  const model::Scene scene = candidate.scene;
  model::Scene dark = scene;
  dark.lights.clear();
  const Fit with = Explain(held_out, scene);
  const double light = with.sum - Explain(held_out, dark).sum;
  const double values = static_cast<double>(held_out.used) * held_out.channels;
  std::vector<model::Light> kept;
  for (std::size_t l = 0; l < scene.lights.size(); ++l) {
    const Fit without = Explain(held_out, Without(scene, l));
    const double share = (with.sum - without.sum) / std::max(light, 1e-300);
    const double ratio = ExcessVariance(without.square / values, sample.noise) /
                         ExcessVariance(with.square / values, sample.noise);
    const bool matters =
        without.square > with.square && (share > kLeastShare || ratio > RatioFor(kLightPrice));
    const Eigen::Vector3d& u = scene.lights[l].direction;
    ladder.push_back(
        {"held-out light", matters,
         Format("the light from (%+.2f, %+.2f, %+.2f) gives %.2g %% of the light on held-out "
                "pixels, and without it their excess variance is %.3g times as large; it counts "
                "from %.1g %% or %.0f times",
                u.x(), u.y(), u.z(), 100.0 * share, ratio, 100.0 * kLeastShare,
                RatioFor(kLightPrice))});
    if (matters || sample.choice.lights) kept.push_back(scene.lights[l]);
  }
  if (kept.size() == scene.lights.size()) return candidate;
  candidate.scene.lights = kept;
  return Eliminate(sample, candidate);
}

}  // namespace turnlight::estimator::start
