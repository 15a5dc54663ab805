#include "rig/sim/random_scene.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "base/angles.h"
#include "base/random.h"

namespace turnlight::rig::sim {
namespace {

using estimator::model::Light;
using estimator::model::Reflectance;
using estimator::model::Scene;

// Streams of random numbers, clear of those of the frames (0, 1, 2, ...).
constexpr std::uint64_t kDirectionStream = std::uint64_t{1} << 40;
constexpr std::uint64_t kLightStream = kDirectionStream + 1;
constexpr std::uint64_t kReflectanceStream = std::uint64_t{2} << 40;

constexpr int kMaxTries = 100000;

double Draw(const RandomStream& random, std::uint64_t index, Interval interval) {
  return random.Uniform(index, interval.low, interval.high);
}

double DrawLog(const RandomStream& random, std::uint64_t index, Interval interval) {
  return std::exp(random.Uniform(index, std::log(interval.low), std::log(interval.high)));
}

Eigen::Vector3d DrawOnCap(const RandomStream& random, std::uint64_t index, double zenith_max) {
  const double z = random.Uniform(2 * index, std::cos(zenith_max), 1.0);
  const double azimuth = random.Uniform(2 * index + 1, 0.0, 2.0 * std::numbers::pi);
  const double across = std::sqrt(std::max(0.0, 1.0 - z * z));
  return {across * std::cos(azimuth), across * std::sin(azimuth), z};
}

double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

Result<std::vector<Light>> DrawLights(const RandomLights& config, std::uint64_t seed) {
  const RandomStream directions(seed, kDirectionStream);
  const RandomStream values(seed, kLightStream);
  const double min_separation = DegToRad(config.min_separation_deg);
  std::vector<Light> lights;
  for (int attempt = 0; attempt < kMaxTries; ++attempt) {
    if (static_cast<int>(lights.size()) == config.count) return lights;
    Light light;
    light.direction = DrawOnCap(directions, attempt, DegToRad(config.zenith_max_deg)).normalized();
    bool apart = true;
    for (const Light& other : lights)
      apart &= AngleBetween(light.direction, other.direction) >= min_separation;
    if (!apart) continue;
    const std::uint64_t first = 3 * lights.size();
    light.intensity = Draw(values, first, config.intensity);
    light.inverse_distance = values.Uniform(first + 1) < config.distant_share
                                 ? 0.0
                                 : 1.0 / DrawLog(values, first + 2, config.distance);
    lights.push_back(light);
  }
  if (static_cast<int>(lights.size()) == config.count) return lights;
  char text[200];
  std::snprintf(text, sizeof text,
                "random_lights/min_separation_deg: %g, but only %zu of %d lights found a place "
                "within %g degrees of +z; allowed is less separation, fewer lights or a larger "
                "zenith_max_deg",
                config.min_separation_deg, lights.size(), config.count, config.zenith_max_deg);
  return InputError(text);
}

std::vector<Light> ListedLights(const std::vector<LightSpec>& list) {
  std::vector<Light> lights;
  lights.reserve(list.size());
  for (const LightSpec& spec : list)
    lights.push_back({spec.direction.normalized(), spec.distance ? 1.0 / *spec.distance : 0.0,
                      spec.intensity, spec.color, spec.factors});
  return lights;
}

Reflectance DrawReflectance(const RandomReflectance& config, std::uint64_t seed) {
  const RandomStream random(seed, kReflectanceStream);
  Reflectance reflectance;
  for (int c = 0; c < 3; ++c) reflectance.albedo[c] = Draw(random, c, config.albedo);
  reflectance.ambient = Draw(random, 3, config.ambient);
  reflectance.diffuse = Draw(random, 4, config.diffuse);
  estimator::model::Lobe& lobe = reflectance.lobes[0];
  lobe.model = config.model;
  if (lobe.present()) {
    lobe.strength = Draw(random, 5, config.specular);
    lobe.shape = DrawLog(random, 6, config.shininess);
    // A physical lobe is drawn by the shininess of Phong's that is as wide and as bright.
    if (estimator::model::FactsOf(config.model).physical) {
      lobe.model = estimator::model::SpecularModel::kPhong;
      SetLobeModel(reflectance, config.model);
    }
  }
  reflectance.diffuse_model = config.diffuse_model;
  if (config.diffuse_model == estimator::model::DiffuseModel::kOrenNayar)
    reflectance.roughness = DegToRad(Draw(random, 7, config.roughness_deg));
  return reflectance;
}

}  // namespace

Result<Scene> DrawScene(const SyntheticConfig& config) {
  Scene scene;
  if (const auto* list = std::get_if<std::vector<LightSpec>>(&config.lights)) {
    scene.lights = ListedLights(*list);
  } else {
    auto lights = DrawLights(std::get<RandomLights>(config.lights), config.seed);
    if (!lights) return Forward(lights);
    scene.lights = std::move(*lights);
  }
  if (const auto* given = std::get_if<Reflectance>(&config.reflectance))
    scene.reflectance = *given;
  else
    scene.reflectance =
        DrawReflectance(std::get<RandomReflectance>(config.reflectance), config.seed);
  return scene;
}

}  // namespace turnlight::rig::sim
