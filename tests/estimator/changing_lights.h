// Lights that change from keyframe to keyframe, and observations of them: each tile is a keyframe.
#pragma once

#include "tests/estimator/random_observations.h"

namespace turnlight::estimator {

// Every light with factors of this root mean square about 1 and a mean of 1.
inline model::Scene Changing(model::Scene scene, double rms, std::size_t keyframes,
                             std::uint64_t seed) {
  const RandomStream random(seed, 11);
  std::uint64_t draw = 0;
  for (model::Light& light : scene.lights) {
    double sum = 0.0;
    for (std::size_t k = 0; k < keyframes; ++k) {
      light.factors.push_back(1.0 + rms * random.Normal(draw++));
      sum += light.factors.back();
    }
    for (double& factor : light.factors) factor *= static_cast<double>(keyframes) / sum;
  }
  return scene;
}

// One tile for each keyframe.
inline observe::Observations ChangingPictures(const model::Scene& truth, std::size_t keyframes,
                                              double noise, std::uint64_t seed = 1) {
  RandomObservations random(keyframes * observe::kTile, 3, seed);
  observe::Observations& all = random.observations;
  all.tile_begin.clear();
  for (std::size_t k = 0; k <= keyframes; ++k) all.tile_begin.push_back(k);
  for (std::size_t i = 0; i < random.points.size(); ++i) {
    const RandomPoint& point = random.points[i];
    const Eigen::Vector3d radiance = model::Shade(model::AtKeyframe(truth, i / observe::kTile),
                                                  point.position, point.normal, point.viewer);
    for (int c = 0; c < 3; ++c) all.radiance[c][i] = static_cast<float>(radiance[c]);
  }
  AddNoise(noise, seed, all);
  return all;
}

}  // namespace turnlight::estimator
