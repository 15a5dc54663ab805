// Observations without a picture behind them: random surface points and views, for tests of the
// kernel and the solver.
#pragma once

#include <vector>

#include "base/random.h"
#include "estimator/model/parameters.h"
#include "estimator/model/scene.h"
#include "estimator/observe/observations.h"
#include "tests/estimator/directions.h"

namespace turnlight::estimator {

// Two lights over a glossy material, with these inverse distances (1/R).
inline model::Scene TwoLights(double first = 0.15, double second = 0.25) {
  model::Scene scene;
  scene.lights = {
      {Eigen::Vector3d(0.3, 0.2, 1.0).normalized(), first, 0.9, Eigen::Vector3d::Ones()},
      {Eigen::Vector3d(-0.7, 0.3, 0.6).normalized(), second, 0.6, Eigen::Vector3d::Ones()}};
  model::Reflectance& r = scene.reflectance;
  r.albedo = {0.4, 0.6, 0.7};
  r.ambient = 0.1;
  r.diffuse = 0.6;
  r.lobes[0].strength = 0.3;
  r.lobes[0].shape = 25.0;
  return scene;
}

// Those of a scene with so many lights and Phong's lobe.
inline model::Parameters PlainParameters(int channels, int lights) {
  model::Scene scene;
  scene.lights.resize(static_cast<std::size_t>(lights));
  return {scene, channels};
}

struct RandomPoint {
  Eigen::Vector3d position, normal, viewer;
};

// Points of the unit ball's upper part seen from above, n.v at least 0.3; radiances are random, or
// those of the scene if one is given.
struct RandomObservations {
  observe::Observations observations;
  std::vector<RandomPoint> points;

  RandomObservations(std::size_t count, int channels, std::uint64_t seed,
                     const model::Scene* scene = nullptr) {
    const RandomStream random(seed, 7);
    observe::Observations& out = observations;
    out.channels = channels;
    const std::size_t size = (count + observe::kTile - 1) / observe::kTile * observe::kTile;
    out.Resize(size);
    out.tile_begin = {0, size / observe::kTile};
    out.width = static_cast<int>(observe::kTile);
    out.used = count;
    std::uint64_t draw = 0;
    for (std::size_t i = 0; i < count; ++i) {
      RandomPoint point;
      do {
        point.normal = RandomUnit(random, draw++);
        point.viewer = RandomUnit(random, draw++);
      } while (point.normal.dot(point.viewer) < 0.3 || point.normal.z() < -0.2);
      point.position = point.normal * random.Uniform(1000000 + i, 0.5, 1.0);
      Store(i, point);
      for (int c = 0; c < channels; ++c)
        out.radiance[c][i] = static_cast<float>(
            scene ? model::Shade(*scene, points[i].position, points[i].normal, points[i].viewer)[c]
                  : random.Uniform(2000000 + 3 * i + static_cast<std::uint64_t>(c)));
    }
  }

 private:
  // Rounds the geometry to float first, so that double and float see the same problem.
  void Store(std::size_t i, RandomPoint point) {
    observe::Observations& out = observations;
    const auto rounded = [](const Eigen::Vector3d& v) {
      return Eigen::Vector3d(v.cast<float>().cast<double>());
    };
    point.position = rounded(point.position);
    point.normal = rounded(point.normal);
    const Eigen::Vector3d w =
        rounded(2.0 * point.normal.dot(point.viewer) * point.normal - point.viewer);
    point.viewer = 2.0 * point.normal.dot(w) * point.normal - w;
    for (int k = 0; k < 3; ++k) {
      out.position[k][i] = static_cast<float>(point.position[k]);
      out.normal[k][i] = static_cast<float>(point.normal[k]);
      out.mirrored[k][i] = static_cast<float>(w[k]);
    }
    out.pixel[i] = static_cast<std::uint32_t>(i);
    points.push_back(point);
  }
};

// Independent Gaussian noise of this sigma on every value.
inline void AddNoise(double sigma, std::uint64_t seed, observe::Observations& all) {
  const RandomStream noise(seed, 5);
  for (int c = 0; c < all.channels; ++c)
    for (std::size_t i = 0; i < all.used; ++i)
      all.radiance[c][i] +=
          static_cast<float>(sigma * noise.Normal(3 * i + static_cast<std::uint64_t>(c)));
}

// Weights as noise that is unlike from pixel to pixel gives them, 0.3 to 3.
inline void GiveWeights(std::uint64_t seed, observe::Observations& all) {
  const RandomStream random(seed, 6);
  all.weighted = true;
  all.variance.assign(all.size(), 1.0f);
  all.weight.assign(all.size(), 1.0f);
  for (std::size_t i = 0; i < all.used; ++i)
    all.weight[i] = static_cast<float>(random.Uniform(i, 0.3, 3.0));
}

// 40 tiles of a scene's colour pixels with noise of 0.002, as of a good camera.
inline RandomObservations NoisyObservations(const model::Scene& truth) {
  RandomObservations random(40 * observe::kTile, 3, 3, &truth);
  AddNoise(0.002, 5, random.observations);
  return random;
}

}  // namespace turnlight::estimator
