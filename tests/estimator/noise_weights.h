// Pictures of a glossy ball in a dark room with strong shot noise, estimated with and without the
// sensor's noise model.
#pragma once

#include <algorithm>
#include <vector>

#include "base/angles.h"
#include "base/random.h"
#include "tests/estimator/small_scene.h"

namespace turnlight::estimator {

inline rig::sim::SyntheticConfig ShotNoiseBall(std::uint64_t seed) {
  rig::sim::SyntheticConfig config = TwoLightBall(seed, 0.002, 0.02);
  config.sensor.noise_shot = 0.1;  // 100 electrons at white
  const RandomStream random(seed, 11);
  std::uint64_t draw = 0;
  for (rig::sim::LightSpec& light : LightsOf(config)) {
    light.direction = RandomUnit(random, draw++);
    light.direction.z() = std::abs(light.direction.z()) + 0.2;
    light.direction.normalize();
    light.distance = random.Uniform(draw++, 250.0, 600.0);
  }
  LightsOf(config)[1].direction.head<2>() = -LightsOf(config)[0].direction.head<2>();
  LightsOf(config)[1].direction.normalize();
  LightsOf(config)[1].intensity = 0.25;
  return config;
}

// The noise of the simulated sensor, as a calibration states it.
inline calib::NoiseModel NoiseOfSensor(const rig::sim::SyntheticConfig& config,
                                       const calib::Radiometry& radiometry) {
  const double span = radiometry.white - radiometry.black;
  return {config.sensor.noise_relative * span,
          config.sensor.noise_shot * config.sensor.noise_shot * span, 0.0};
}

struct WeighedErrors {
  double uniform = 0.0, weighted = 0.0;              // degrees, root mean square over the lights
  double uniform_sigma = 0.0, weighted_sigma = 0.0;  // as stated, likewise
};

// The root mean square direction error of two lights and their stated sigma, degrees.
inline std::pair<double, double> DirectionErrorOf(const model::Scene& truth,
                                                  const Estimate& estimate) {
  double square = 0.0, stated = 0.0;
  for (const model::Light& light : truth.lights) {
    double best = 180.0, sigma = 0.0;
    for (const LightEstimate& found : estimate.lights) {
      const double error = RadToDeg(std::acos(
          std::clamp(light.direction.dot(found.light.direction), -1.0, 1.0)));
      if (error >= best) continue;
      best = error;
      sigma = RadToDeg(found.direction_sigma);
    }
    square += best * best;
    stated += sigma * sigma;
  }
  const auto count = static_cast<double>(truth.lights.size());
  return {std::sqrt(square / count), std::sqrt(stated / count)};
}

inline Result<WeighedErrors> EstimateBothWays(std::uint64_t seed) {
  const rig::sim::SyntheticConfig config = ShotNoiseBall(seed);
  auto session = rig::sim::SynthesizeInMemory(config);
  if (!session) return Forward(session);
  EstimateOptions options;
  options.model.lights = 2;
  const auto uniform = EstimateFrom(*session, options);
  if (!uniform) return Forward(uniform);
  session->radiometry.noise = NoiseOfSensor(config, session->radiometry);
  const auto weighted = EstimateFrom(*session, options);
  if (!weighted) return Forward(weighted);
  WeighedErrors out;
  std::tie(out.uniform, out.uniform_sigma) = DirectionErrorOf(session->scene, uniform->estimate);
  std::tie(out.weighted, out.weighted_sigma) = DirectionErrorOf(session->scene, weighted->estimate);
  return out;
}

}  // namespace turnlight::estimator
