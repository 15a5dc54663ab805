#include "estimator/start/usual_models.h"

#include <utility>

#include "estimator/model/reflectance/models.h"

namespace turnlight::estimator::start {
namespace {

constexpr int kTryIterations = 40;
constexpr double kTriedRoughness = 0.3;  // radians
constexpr double kFirstDistance = 0.05;  // 1/R

model::Scene StartOf(const model::Scene& lights, model::SpecularModel lobe,
                     model::DiffuseModel diffuse) {
  model::Scene scene = lights;
  model::Reflectance& r = scene.reflectance;
  r.shading.setZero();
  scene.free_shading = false;
  r.lobes[1] = model::Lobe{};
  model::SetLobeModel(r, lobe);
  r.diffuse_model = diffuse;
  r.roughness = diffuse == model::DiffuseModel::kOrenNayar ? kTriedRoughness : 0.0;
  for (model::Light& light : scene.lights) light.inverse_distance = kFirstDistance;
  return scene;
}

}  // namespace

bool UsualModelsExplain(const Sample& sample, const model::Scene& lights) {
  Candidate best;
  const auto explains = [&](const model::Scene& start) {
    Candidate first;
    first.scene = start;
    Candidate fitted = Refit(sample, first, kTryIterations, sample.noise, kToCompare);
    if (best.scene.lights.empty() || fitted.excess < best.excess) best = std::move(fitted);
    return NothingLeft(best.excess, sample);
  };
  for (const model::DiffuseModel diffuse :
       {model::DiffuseModel::kLambert, model::DiffuseModel::kCoated,
        model::DiffuseModel::kOrenNayar})
    for (int number = 1; number <= model::reflectance::Lobes::kCount; ++number)
      if (explains(StartOf(lights, static_cast<model::SpecularModel>(number), diffuse)))
        return true;
  const model::Scene least = best.scene;
  const bool several = sample.pixels.tile_begin.size() > 2;
  for (const int variant : {0, 1, 2}) {
    model::Scene scene = least;
    if (variant == 0) scene.free_colours = sample.pixels.channels > 1;
    if (variant == 1) scene.free_factors = several;
    if (variant == 2) scene.free_harmonics = true;
    if (!scene.free_colours && !scene.free_factors && !scene.free_harmonics) continue;
    if (explains(scene)) return true;
  }
  return false;
}

}  // namespace turnlight::estimator::start
