#include "bench/studies/random_scene.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "base/angles.h"
#include "base/random.h"
#include "bench/studies/seen.h"
#include "estimator/solve/normal_equations.h"

namespace turnlight::studies {
namespace {

using estimator::model::Light;
using estimator::model::Reflectance;

constexpr std::uint64_t kSetupStream = std::uint64_t{1} << 48;  // the attempts follow it
constexpr int kAttempts = 400;
constexpr int kTriesPerLight = 60;
constexpr int kMinPixels = 4;
constexpr int kMinViews = 2;
constexpr double kMinPeak = 0.05;
constexpr double kLobeWidths = 2.0;

// Draws one number after the other.
class Draws {
 public:
  Draws(std::uint64_t number, std::uint64_t stream) : random_(number, stream) {}
  double Uniform(double low = 0.0, double high = 1.0) {
    return random_.Uniform(next_++, low, high);
  }
  double Log(double low, double high) { return std::exp(Uniform(std::log(low), std::log(high))); }
  int Integer(int low, int high) {
    return std::min(high, low + static_cast<int>(Uniform() * (high - low + 1)));
  }
  bool Chance(double probability) { return Uniform() < probability; }

 private:
  RandomStream random_;
  std::uint64_t next_ = 0;
};

enum class Kind { kSphere, kBoard, kBlob };

rig::sim::Sensor DrawSensor(Draws& draw) {
  rig::sim::Sensor sensor;
  const double which = draw.Uniform();
  sensor.depth = which < 0.5 ? rig::sim::SensorDepth::k16 : rig::sim::SensorDepth::k8;
  if (which >= 0.75) sensor.encoding = calib::Encoding::kSrgb;
  sensor.black = sensor.depth == rig::sim::SensorDepth::k16 ? 4096.0 : 16.0;
  const bool clean = draw.Chance(0.25);
  const double noise = draw.Log(0.001, 0.01);
  sensor.noise_relative = clean ? 0.0 : noise;
  return sensor;
}

rig::sim::SyntheticConfig DrawSetup(std::uint64_t number, Kind& kind) {
  Draws draw(number, kSetupStream);
  const double which = draw.Uniform();
  kind = which < 0.7 ? Kind::kSphere : which < 0.85 ? Kind::kBoard : Kind::kBlob;
  rig::sim::SyntheticConfig config;
  config.seed = number;
  config.name = "random_" + std::to_string(number);
  if (kind == Kind::kBoard) config.target = calib::PlaneShape{160.0, 120.0};
  const double depth = draw.Uniform(0.1, 0.25);
  if (kind == Kind::kBlob) config.target = rig::sim::Blob{40.0, depth, 96};
  const bool orbit = kind == Kind::kSphere;
  config.motion.kind = orbit ? rig::sim::MotionKind::kOrbit : rig::sim::MotionKind::kTable;
  config.motion.frames = orbit ? draw.Integer(6, 20) : draw.Integer(12, 24);
  config.motion.step_deg = 360.0 / config.motion.frames;
  config.motion.elevation_deg =
      kind == Kind::kBoard ? draw.Uniform(40.0, 65.0) : draw.Uniform(15.0, 55.0);
  const double tilt = draw.Uniform(12.0, 28.0);
  if (kind == Kind::kBoard) config.motion.tilt_deg = tilt;
  config.motion.distance = draw.Uniform(300.0, 600.0);
  config.camera.width = 200;
  config.camera.height = 150;
  config.camera.focal_px =
      0.4 * config.camera.height * config.motion.distance / rig::sim::TargetRadius(config.target);
  config.sensor = DrawSensor(draw);
  config.samples_per_side = 5;
  return config;
}

Reflectance DrawMaterial(Draws& draw) {
  Reflectance material;
  for (int c = 0; c < 3; ++c) material.albedo[c] = draw.Uniform(0.2, 0.9);
  material.ambient = draw.Uniform(0.01, 0.1);
  material.diffuse = draw.Uniform(0.3, 0.7);
  material.lobes[0].strength = draw.Uniform(0.15, 0.6);
  material.lobes[0].shape = draw.Log(20.0, 300.0);
  if (draw.Chance(0.1)) {
    material.diffuse_model = estimator::model::DiffuseModel::kOrenNayar;
    material.roughness = DegToRad(draw.Uniform(10.0, 30.0));
  }
  return material;
}

// A place for a light: on a board where some pixel mirrors the camera, as most of the sky is never
// mirrored; else anywhere up to 85 degrees from +z.
Light DrawLight(Draws& draw, Kind kind, double radius, const SeenSurface& seen) {
  Light light;
  const bool distant = draw.Chance(0.25);
  const double distance = radius * draw.Log(4.0, 30.0);
  const double z = draw.Uniform(std::cos(DegToRad(85.0)), 1.0);
  const double azimuth = draw.Uniform(0.0, 2.0 * std::numbers::pi);
  const double pick = draw.Uniform();
  light.intensity = draw.Log(1.0, 5.0);
  const double across = std::sqrt(1.0 - z * z);
  light.direction = Eigen::Vector3d(across * std::cos(azimuth), across * std::sin(azimuth), z);
  if (kind == Kind::kBoard) {
    const auto& pixels = seen.pixels();
    const SeenPixel& pixel =
        pixels[static_cast<std::size_t>(pick * static_cast<double>(pixels.size()))];
    light.direction = distant ? pixel.mirrored : pixel.position + distance * pixel.mirrored;
    light.direction.normalize();
  }
  light.inverse_distance = distant ? 0.0 : 1.0 / distance;
  return light;
}

bool FarEnough(const Light& light, const std::vector<Light>& others, double separation) {
  for (const Light& other : others)
    if (std::atan2(light.direction.cross(other.direction).norm(),
                   light.direction.dot(other.direction)) < separation)
      return false;
  return true;
}

// Lights that are far enough apart and whose highlights are seen; none if they found no place.
std::vector<Light> DrawLights(Draws& draw, Kind kind, int count, double radius, double shininess,
                              const SeenSurface& seen) {
  const double separation =
      kLobeWidths * 2.0 *
      estimator::model::LobeHalfWidth({estimator::model::SpecularModel::kPhong, 1.0, shininess});
  std::vector<Light> lights;
  for (int attempt = 0; attempt < kTriesPerLight * count; ++attempt) {
    if (static_cast<int>(lights.size()) == count) return lights;
    const Light light = DrawLight(draw, kind, radius, seen);
    if (FarEnough(light, lights, separation) &&
        seen.ViewsOfHighlight(light, shininess, kMinPixels) >= kMinViews)
      lights.push_back(light);
  }
  return {};
}

// Scales light and ambient so that the brightest pixel is at `level`.
void Expose(estimator::model::Scene& scene, const SeenSurface& seen, double level) {
  const double factor = level / seen.Brightest(scene);
  for (Light& light : scene.lights) light.intensity *= factor;
  scene.reflectance.ambient *= factor;
}

std::optional<estimator::model::Scene> TryScene(std::uint64_t number, int attempt, Kind kind,
                                                int count, double radius, const SeenSurface& seen) {
  Draws draw(number, kSetupStream + 1 + static_cast<std::uint64_t>(attempt));
  estimator::model::Scene scene;
  const bool clipped = draw.Chance(0.15);
  const double level = clipped ? draw.Uniform(1.1, 1.4) : draw.Uniform(0.7, 0.95);
  scene.reflectance = DrawMaterial(draw);
  scene.lights = DrawLights(draw, kind, count, radius, scene.reflectance.lobes[0].shape, seen);
  if (scene.lights.empty()) return std::nullopt;
  Expose(scene, seen, level);
  for (const Light& light : scene.lights)
    if (seen.HighlightPeak(scene, light) < kMinPeak) return std::nullopt;
  return scene;
}

}  // namespace

Result<rig::sim::SyntheticConfig> RandomScene(std::uint64_t number) {
  Kind kind = Kind::kSphere;
  rig::sim::SyntheticConfig config = DrawSetup(number, kind);
  const auto seen = SeenSurface::Build(config);
  if (!seen) return Forward(seen);
  Draws draw(number, kSetupStream - 1);
  const int count = draw.Integer(1, kind == Kind::kBoard ? 3 : 8);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const auto scene =
        TryScene(number, attempt, kind, count, rig::sim::TargetRadius(config.target), *seen);
    if (!scene) continue;
    std::vector<rig::sim::LightSpec> lights;
    for (const Light& light : scene->lights)
      lights.push_back({light.direction,
                        light.inverse_distance > 0.0
                            ? std::optional<double>(1.0 / light.inverse_distance)
                            : std::nullopt,
                        light.intensity, Eigen::Vector3d::Ones()});
    config.lights = std::move(lights);
    config.reflectance = scene->reflectance;
    return config;
  }
  return InputError("scene " + std::to_string(number) + ": " + std::to_string(count) +
                    " lights found no place");
}

}  // namespace turnlight::studies
