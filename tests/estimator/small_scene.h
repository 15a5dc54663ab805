// A glossy ball, 120 x 90 pixels, as several tests of whole estimates need it.
#pragma once

#include <vector>

#include "estimator/estimate.h"
#include "rig/sim/synthetic_session.h"
#include "tests/estimator/directions.h"

namespace turnlight::estimator {

// Six views all around, no noise.
inline rig::sim::SyntheticConfig SmallBall(std::vector<rig::sim::LightSpec> lights,
                                           const model::Reflectance& reflectance) {
  rig::sim::SyntheticConfig config;
  config.motion.frames = 6;
  config.motion.step_deg = 60.0;
  config.camera = {.width = 120, .height = 90, .focal_px = 300.0, .distortion = {}};
  config.lights = std::move(lights);
  config.reflectance = reflectance;
  return config;
}

inline model::Reflectance Glossy(double ambient, double diffuse, double specular) {
  model::Reflectance reflectance;
  reflectance.albedo = {0.4, 0.6, 0.7};
  reflectance.ambient = ambient;
  reflectance.diffuse = diffuse;
  reflectance.lobes[0].strength = specular;
  reflectance.lobes[0].shape = 30.0;
  return reflectance;
}

// Two near lights; a black level keeps the noise below zero.
inline rig::sim::SyntheticConfig TwoLightBall(std::uint64_t seed, double noise, double ambient) {
  rig::sim::SyntheticConfig config =
      SmallBall({{.direction = {0.4, 0.2, 0.9}, .distance = 300.0, .intensity = 0.8},
                 {.direction = {-0.6, 0.4, 0.6}, .distance = 500.0, .intensity = 0.6}},
                Glossy(ambient, 0.6, 0.3));
  config.seed = seed;
  config.sensor.black = 6000.0;
  config.sensor.noise_relative = noise;
  return config;
}

inline std::vector<rig::sim::LightSpec>& LightsOf(rig::sim::SyntheticConfig& config) {
  return std::get<std::vector<rig::sim::LightSpec>>(config.lights);
}

inline Result<EstimateOutput> EstimateFrom(const rig::sim::SyntheticSession& session,
                                           const EstimateOptions& options = {}) {
  return EstimateScene(rig::sim::ToKeyframes(session), target::Geometry(session.target),
                       calib::RayGrid(session.camera), options);
}

}  // namespace turnlight::estimator
