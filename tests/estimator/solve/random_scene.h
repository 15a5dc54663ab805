// A scene at random, with every property that derivatives are taken by.
#pragma once

#include <cmath>

#include "base/random.h"
#include "estimator/model/scene.h"
#include "tests/estimator/directions.h"

namespace turnlight::estimator::solve {

inline constexpr int kRandomLights = 2;

inline model::Scene RandomScene(std::uint64_t seed, model::SpecularModel specular,
                                model::DiffuseModel diffuse) {
  const RandomStream random(seed, 1);
  model::Scene scene;
  for (int l = 0; l < kRandomLights; ++l) {
    model::Light light;
    light.direction = RandomUnit(random, 100 + static_cast<std::uint64_t>(l));
    light.direction.z() = std::abs(light.direction.z());
    light.inverse_distance = random.Uniform(10 + static_cast<std::uint64_t>(l), 0.0, 0.5);
    light.intensity = random.Uniform(20 + static_cast<std::uint64_t>(l), 0.3, 1.0);
    scene.lights.push_back(light);
  }
  model::Reflectance& r = scene.reflectance;
  r.albedo = {random.Uniform(30), random.Uniform(31), random.Uniform(32)};
  r.ambient = random.Uniform(33, 0.0, 0.3);
  r.diffuse = random.Uniform(34, 0.2, 1.0);
  r.lobes[0].strength = random.Uniform(35, 0.1, 0.6);
  r.lobes[0].shape = std::exp(random.Uniform(36, std::log(2.0), std::log(300.0)));
  r.lobes[0].model = specular;
  if (model::FactsOf(specular).physical) {
    r.lobes[0].shape = random.Uniform(36, 0.1, 0.8);
    r.lobes[0].f0 = random.Uniform(38, 0.1, 0.9);
  }
  r.diffuse_model = diffuse;
  r.roughness = random.Uniform(37, 0.1, 0.8);
  return scene;
}

}  // namespace turnlight::estimator::solve
