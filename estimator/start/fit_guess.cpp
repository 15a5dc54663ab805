#include "estimator/start/fit_guess.h"

#include "base/format.h"
#include "estimator/solve/coordinates.h"
#include "estimator/start/find_lights.h"
#include "estimator/start/start_scene.h"

namespace turnlight::estimator::start {
namespace {

constexpr double kLeastFallElsewhere =
    3.0;  // of the excess variance, for lights that were not given

model::Scene StartFromGuess(const Sample& sample, const model::InitialGuess& guess) {
  model::Scene world;
  world.lights = guess.lights;
  const model::Scene given = solve::ToSolver(world, sample.pixels);
  std::vector<Eigen::Vector3d> directions;
  for (const model::Light& light : given.lights) directions.push_back(light.direction);
  model::Scene start = StartFromDirections(sample.pixels, directions);
  double total = 0.0;
  for (const model::Light& light : given.lights) total += light.intensity;
  for (std::size_t l = 0; l < start.lights.size(); ++l) {
    if (guess.lights[l].inverse_distance > 0.0)
      start.lights[l].inverse_distance = given.lights[l].inverse_distance;
    if (guess.has_intensities && total > 0.0)
      start.lights[l].intensity *=
          given.lights[l].intensity / total * static_cast<double>(start.lights.size());
  }
  model::Reflectance& r = start.reflectance;
  if (guess.reflectance) {
    const double peak = model::LobePeak(r.lobes[0]);
    r.lobes = guess.reflectance->lobes;
    for (model::Lobe& lobe : r.lobes) {
      lobe.strength = 1.0;
      lobe.strength = lobe.present() ? peak / model::LobePeak(lobe) : 0.0;
    }
    r.diffuse_model = guess.reflectance->diffuse_model;
    r.roughness = guess.reflectance->roughness;
  }
  if (sample.choice.specular && *sample.choice.specular != r.lobes[0].model)
    r.lobes[0] = model::Converted(r.lobes[0], *sample.choice.specular);
  r.diffuse_model = sample.choice.diffuse.value_or(r.diffuse_model);
  start.free_factors = sample.choice.changing.value_or(false);
  start.free_harmonics = sample.choice.harmonics.value_or(false);
  return start;
}

}  // namespace

Candidate FitGuess(const Sample& sample, const model::InitialGuess& guess,
                   const std::vector<observe::MapPoint>& clusters,
                   std::vector<model::Rung>& ladder) {
  Candidate fitted = FitStart(sample, StartFromGuess(sample, guess));
  const std::size_t count = guess.lights.size();
  if (!NothingLeft(fitted.excess, sample)) {
    Sample as_many = sample;
    as_many.choice.lights = static_cast<int>(count);
    std::vector<model::Rung> own;
    Candidate found = FindLights(as_many, clusters, own);
    const bool elsewhere =
        found.scene.lights.size() == count && found.excess * kLeastFallElsewhere < fitted.excess;
    ladder.push_back({"initial", !elsewhere,
                      Format("from the lights given the excess variance is %.3g, without them %.3g",
                             fitted.excess, found.excess)});
    if (elsewhere) fitted = std::move(found);
  }
  ladder.push_back({"lights", true, Format("%zu, as given by --initial", count)});
  return fitted;
}

}  // namespace turnlight::estimator::start
