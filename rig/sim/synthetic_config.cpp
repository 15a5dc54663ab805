#include "rig/sim/synthetic_config.h"

#include <algorithm>
#include <cmath>

#include "base/angles.h"
#include "base/format.h"
#include "estimator/model/direction_lattice.h"

namespace turnlight::rig::sim {
namespace {

constexpr double kMaxLength = 1e9;
constexpr double kMaxValue = 1e6;

void Within(ConfigChecker& check, const std::string& key, Interval interval, double min,
            double max) {
  check.Require(interval.low >= min && interval.low <= interval.high && interval.high <= max, key,
                "[" + NumberText(interval.low) + ", " + NumberText(interval.high) +
                    "], allowed is a pair of rising numbers from " + NumberText(min) + " to " +
                    NumberText(max));
}

void CheckTarget(ConfigChecker& check, const SyntheticTarget& target) {
  if (const auto* sphere = std::get_if<calib::SphereShape>(&target)) {
    check.Above("target/radius", sphere->radius, 0.0, kMaxLength);
  } else if (const auto* plane = std::get_if<calib::PlaneShape>(&target)) {
    check.Above("target/size", std::min(plane->width, plane->height), 0.0, kMaxLength);
    check.Above("target/size", std::max(plane->width, plane->height), 0.0, kMaxLength);
    check.From("target/sides", plane->sides, 1, 2);
  } else if (const auto* blob = std::get_if<Blob>(&target)) {
    check.Above("target/radius", blob->radius, 0.0, kMaxLength);
    check.From("target/depth", blob->depth, 0.0, 0.5);
    check.From("target/segments", blob->segments, 8, 1024);
    check.Require(blob->segments % 2 == 0, "target/segments",
                  NumberText(blob->segments) + ", allowed is an even number");
  }
}

void CheckMotion(ConfigChecker& check, const SyntheticConfig& config) {
  const Motion& motion = config.motion;
  check.From("motion/frames", motion.frames, 1, 10000);
  check.From("motion/step_deg", motion.step_deg, -360.0, 360.0);
  check.Above("motion/distance", motion.distance, TargetRadius(config.target), kMaxLength,
              "the target's radius");
  check.From("motion/elevation_deg", motion.elevation_deg, -90.0, 90.0);
  check.From("motion/tilt_deg", motion.tilt_deg, -90.0, 90.0);
  check.Require(motion.tilt_deg == 0.0 || std::holds_alternative<calib::PlaneShape>(config.target),
                "motion/tilt_deg",
                NumberText(motion.tilt_deg) + ", allowed is 0, as only a plane is tilted");
}

void CheckCamera(ConfigChecker& check, const SyntheticCamera& camera) {
  check.From("camera/size", camera.width, 8, 16384);
  check.From("camera/size", camera.height, 8, 16384);
  check.Above("camera/focal_px", camera.focal_px, 0.0, kMaxValue);
  check.From("camera/vignetting", camera.vignetting, 0.0, 1.0);
  if (!camera.distortion) return;
  for (const double value : *camera.distortion) check.From("camera/distortion", value, -100, 100);
}

void CheckColour(ConfigChecker& check, const std::string& key, const Eigen::Vector3d& colour) {
  check.From(key, colour.minCoeff(), 0.0, kMaxValue);
  check.From(key, colour.maxCoeff(), 0.0, kMaxValue);
}

void CheckLights(ConfigChecker& check, const SyntheticConfig& config) {
  const double radius = TargetRadius(config.target);
  if (const auto* list = std::get_if<std::vector<LightSpec>>(&config.lights)) {
    check.Require(list->size() <= 64, "lights", "more than 64 lights, allowed are at most 64");
    for (std::size_t i = 0; i < list->size(); ++i) {
      const LightSpec& light = (*list)[i];
      const std::string at = "lights/" + std::to_string(i);
      const double length = light.direction.norm();
      check.Require(std::isfinite(length) && length > 0.0, at + "/direction",
                    "it has no length, allowed is any other vector");
      if (light.distance)
        check.Above(at + "/distance", *light.distance, radius, kMaxLength, "the target's radius");
      check.Above(at + "/intensity", light.intensity, 0.0, kMaxValue);
      CheckColour(check, at + "/color", light.color);
      const std::size_t factors = light.factors.size();
      check.Require(factors == 0 || factors == static_cast<std::size_t>(config.motion.frames),
                    at + "/factors",
                    std::to_string(factors) + " numbers, allowed is one for each of the " +
                        std::to_string(config.motion.frames) + " frames");
      for (const double factor : light.factors) check.From(at + "/factors", factor, 0.0, kMaxValue);
    }
    return;
  }
  const auto& random = std::get<RandomLights>(config.lights);
  check.From("random_lights/count", random.count, 1, 64);
  check.From("random_lights/min_separation_deg", random.min_separation_deg, 0.0, 180.0);
  check.From("random_lights/zenith_max_deg", random.zenith_max_deg, 0.0, 180.0);
  check.Above("random_lights/distance", random.distance.low, radius, kMaxLength,
              "the target's radius");
  Within(check, "random_lights/distance", random.distance, 0.0, kMaxLength);
  check.From("random_lights/distant_share", random.distant_share, 0.0, 1.0);
  check.Above("random_lights/intensity", random.intensity.low, 0.0, kMaxValue);
  Within(check, "random_lights/intensity", random.intensity, 0.0, kMaxValue);
}

void CheckReflectance(ConfigChecker& check, const SyntheticConfig& config) {
  if (const auto* given = std::get_if<estimator::model::Reflectance>(&config.reflectance)) {
    CheckColour(check, "reflectance/albedo", given->albedo);
    check.From("reflectance/ambient", given->ambient, 0.0, kMaxValue);
    check.From("reflectance/diffuse", given->diffuse, 0.0, kMaxValue);
    CheckColour(check, "reflectance/ambient_color", given->ambient_colour);
    CheckColour(check, "reflectance/specular_color", given->specular_colour);
    for (const Eigen::Vector3d& normal : estimator::model::SphereDirections(500))
      check.Require(estimator::model::AmbientTerm(*given, normal) >= 0.0,
                    "reflectance/ambient_harmonics",
                    "ambient light below 0 from some side, allowed are smaller harmonics");
    for (const estimator::model::Lobe& lobe : given->lobes) {
      const auto& facts = FactsOf(lobe.model);
      check.From("reflectance/specular", lobe.strength, 0.0, kMaxValue);
      check.From(std::string("reflectance/") + facts.shape_key, lobe.shape, facts.least_shape,
                 facts.most_shape);
    }
    check.From("reflectance/roughness_deg", RadToDeg(given->roughness), 0.0, 90.0);
    return;
  }
  const auto& random = std::get<RandomReflectance>(config.reflectance);
  Within(check, "random_reflectance/albedo", random.albedo, 0.0, kMaxValue);
  Within(check, "random_reflectance/ambient", random.ambient, 0.0, kMaxValue);
  Within(check, "random_reflectance/diffuse", random.diffuse, 0.0, kMaxValue);
  Within(check, "random_reflectance/specular", random.specular, 0.0, kMaxValue);
  const auto& phong = FactsOf(estimator::model::SpecularModel::kPhong);
  Within(check, "random_reflectance/shininess", random.shininess, phong.least_shape,
         phong.most_shape);
  Within(check, "random_reflectance/roughness_deg", random.roughness_deg, 0.0, 90.0);
}

void CheckSensor(ConfigChecker& check, const Sensor& sensor) {
  const bool is_float = sensor.depth == SensorDepth::kFloat;
  const double top = sensor.depth == SensorDepth::k8    ? 255.0
                     : sensor.depth == SensorDepth::k16 ? 65535.0
                                                        : 1e9;
  const calib::Radiometry radiometry = sensor.ToRadiometry();
  if (is_float)
    check.Require(sensor.Format() != FileFormat::kPng, "sensor/format",
                  "png, allowed for float pictures is one of exr, tiff");
  else
    check.Require(sensor.Format() != FileFormat::kExr, "sensor/format",
                  "exr, allowed for pictures of 8 and 16 bits is one of png, tiff");
  check.Above("sensor/encoding", sensor.gamma, 0.0, 10.0);
  check.From("sensor/black", sensor.black, is_float ? -1e9 : 0.0, top);
  check.Above("sensor/white", radiometry.white, sensor.black, top, "black");
  check.Above("sensor/saturation", radiometry.SaturationDn(), sensor.black, top, "black");
  check.From("sensor/noise_relative", sensor.noise_relative, 0.0, 1.0);
  check.From("sensor/noise_shot", sensor.noise_shot, 0.0, 1.0);
  if (sensor.clip_share) check.From("sensor/clip_share", *sensor.clip_share, 0.0, 0.9);
}

}  // namespace

FileFormat Sensor::Format() const {
  return format.value_or(depth == SensorDepth::kFloat ? FileFormat::kExr : FileFormat::kPng);
}

calib::Radiometry Sensor::ToRadiometry() const {
  calib::Radiometry radiometry;
  radiometry.encoding = encoding;
  radiometry.gamma = gamma;
  radiometry.black = black;
  radiometry.white = white.value_or(depth == SensorDepth::k8    ? 255.0
                                    : depth == SensorDepth::k16 ? 65535.0
                                                                : 1.0);
  radiometry.saturation = saturation;
  return radiometry;
}

double TargetRadius(const SyntheticTarget& target) {
  if (const auto* sphere = std::get_if<calib::SphereShape>(&target)) return sphere->radius;
  if (const auto* plane = std::get_if<calib::PlaneShape>(&target))
    return 0.5 * std::hypot(plane->width, plane->height);
  const auto& blob = std::get<Blob>(target);
  return blob.radius * (1.0 + blob.depth);
}

std::optional<ConfigProblem> Validate(const SyntheticConfig& config) {
  ConfigChecker check;
  check.From("seed", static_cast<double>(config.seed), 0.0, 0x1p53);
  check.Require(
      !config.name.empty() && config.name.size() <= 200, "name",
      "it has " + std::to_string(config.name.size()) + " characters, allowed are 1 to 200");
  CheckTarget(check, config.target);
  CheckMotion(check, config);
  CheckCamera(check, config.camera);
  CheckLights(check, config);
  CheckReflectance(check, config);
  CheckSensor(check, config.sensor);
  check.From("samples_per_side", config.samples_per_side, 1, 32);
  return check.problem();
}

}  // namespace turnlight::rig::sim
