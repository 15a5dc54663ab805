#include "estimator/start/fit_guess.h"

#include "base/format.h"
#include "estimator/solve/coordinates.h"
#include "estimator/start/find_lights.h"
#include "estimator/start/score.h"
#include "estimator/start/start_scene.h"

namespace turnlight::estimator::start {
namespace {

// What lights must explain that are not those that were given, as a light.
constexpr double kElsewherePrice = kLightPrice;

const Eigen::Vector3d kWhite = Eigen::Vector3d::Ones();

// Whether the guess's colours are taken, and are free: where it has some, or the user asks for it.
bool TakesColours(const Sample& sample, const model::InitialGuess& guess) {
  if (sample.pixels.channels == 1) return false;
  model::Scene given;
  given.lights = guess.lights;
  if (guess.reflectance) given.reflectance = *guess.reflectance;
  return sample.choice.coloured.value_or(given.coloured());
}

// The light's colour, its largest channel 1; intensities stay what they are together.
void TakeColour(bool coloured, model::Light& light) {
  const double largest = light.color.maxCoeff();
  if (coloured && largest > 0.0) {
    light.intensity *= largest;
    light.color /= largest;
  } else {
    light.intensity = model::Strength(light);
    light.color = kWhite;
  }
}

// All lobes that were given, as bright together as the start's own and as they were to each other.
void TakeLobes(const model::Reflectance& given, model::Reflectance& r) {
  const double start = model::LobePeak(r.lobes[0]);
  double together = 0.0;
  for (const model::Lobe& lobe : given.lobes)
    if (lobe.present()) together += model::LobePeak(lobe);
  r.lobes = given.lobes;
  for (model::Lobe& lobe : r.lobes) {
    const double share = together > 0.0 ? model::LobePeak(lobe) / together : 1.0;
    lobe.strength = 1.0;
    lobe.strength = lobe.present() ? start * share / model::LobePeak(lobe) : 0.0;
  }
}

// The largest channel 1, as a fit holds it; a colour that is none is white.
Eigen::Vector3d ColourOf(const Eigen::Vector3d& colour) {
  const double largest = colour.maxCoeff();
  return largest > 0.0 ? Eigen::Vector3d(colour / largest) : kWhite;
}

model::Scene StartFromGuess(const Sample& sample, const model::InitialGuess& guess) {
  const bool coloured = TakesColours(sample, guess);
  model::Scene world;
  world.lights = guess.lights;
  for (model::Light& light : world.lights) TakeColour(coloured, light);
  const model::Scene given = solve::ToSolver(world, sample.pixels);
  std::vector<Eigen::Vector3d> directions;
  for (const model::Light& light : given.lights) directions.push_back(light.direction);
  model::Scene start = StartFromDirections(sample.pixels, directions);
  start.free_colours = coloured;
  double total = 0.0;
  for (const model::Light& light : given.lights) total += light.intensity;
  for (std::size_t l = 0; l < start.lights.size(); ++l) {
    start.lights[l].color = given.lights[l].color;
    if (guess.lights[l].inverse_distance > 0.0)
      start.lights[l].inverse_distance = given.lights[l].inverse_distance;
    if (guess.has_intensities && total > 0.0)
      start.lights[l].intensity *=
          given.lights[l].intensity / total * static_cast<double>(start.lights.size());
  }
  model::Reflectance& r = start.reflectance;
  if (guess.reflectance) {
    TakeLobes(*guess.reflectance, r);
    if (coloured) {
      r.ambient_colour = ColourOf(guess.reflectance->ambient_colour);
      r.specular_colour = ColourOf(guess.reflectance->specular_colour);
    }
    r.diffuse_model = guess.reflectance->diffuse_model;
    r.roughness = guess.reflectance->roughness;
  }
  if (sample.choice.specular) model::SetLobeModel(r, *sample.choice.specular);
  r.diffuse_model = sample.choice.diffuse.value_or(r.diffuse_model);
  if (sample.choice.lobes == 1) r.lobes[1] = model::Lobe{};
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
    const bool elsewhere = found.scene.lights.size() == count &&
                           found.excess * RatioFor(kElsewherePrice) < fitted.excess;
    ladder.push_back({"initial", !elsewhere,
                      Format("from the lights given the excess variance is %.3g, without them %.3g",
                             fitted.excess, found.excess)});
    if (elsewhere) fitted = std::move(found);
  }
  ladder.push_back({"lights", true, Format("%zu, as given by --initial", count)});
  return fitted;
}

}  // namespace turnlight::estimator::start
