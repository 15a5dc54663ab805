#include "estimator/start/start_scene.h"

#include <algorithm>

#include "estimator/observe/radiance_statistics.h"

namespace turnlight::estimator::start {

model::Scene StartFromDirections(const observe::Observations& observations,
                                 const std::vector<Eigen::Vector3d>& directions) {
  model::Scene scene;
  const Eigen::Vector3d median = observe::MedianColour(observations).cwiseMax(1e-6);
  model::Reflectance& r = scene.reflectance;
  r.albedo = median / median.maxCoeff();
  r.ambient = std::max(observe::DarkRadiance(observations, 0) / r.albedo[0], 0.0);
  r.diffuse = 1.0;
  r.lobes[0].strength = 0.5;
  r.lobes[0].shape = 20.0;
  for (const Eigen::Vector3d& direction : directions) {
    model::Light light;
    light.direction = direction;
    light.inverse_distance = 0.05;
    light.intensity = median.maxCoeff() / static_cast<double>(directions.size());
    scene.lights.push_back(light);
  }
  return scene;
}

}  // namespace turnlight::estimator::start
