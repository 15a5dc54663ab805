#include "estimator/start_scene.h"

#include <algorithm>

#include "estimator/radiance_statistics.h"

namespace turnlight::estimator {

Scene StartFromDirections(const Observations& observations,
                          const std::vector<Eigen::Vector3d>& directions) {
  Scene scene;
  const Eigen::Vector3d median = MedianColour(observations).cwiseMax(1e-6);
  Reflectance& r = scene.reflectance;
  r.albedo = median / median.maxCoeff();
  r.ambient = std::max(DarkRadiance(observations, 0) / r.albedo[0], 0.0);
  r.diffuse = 1.0;
  r.specular = 0.5;
  r.shininess = 20.0;
  for (const Eigen::Vector3d& direction : directions) {
    Light light;
    light.direction = direction;
    light.inverse_distance = 0.05;
    light.intensity = median.maxCoeff() / static_cast<double>(directions.size());
    scene.lights.push_back(light);
  }
  return scene;
}

}  // namespace turnlight::estimator
