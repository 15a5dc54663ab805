// The quantities that are reported about a scene.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "estimator/model/scene.h"
#include "estimator/observe/observations.h"

namespace turnlight::estimator::uncertainty {

// What is reported about a scene, in W and in the gauge of the results (max(albedo) = 1, light 0
// has intensity 1, the scene's white_light is white, the largest channel of every colour is 1),
// lights in a fixed order.
struct ReportedLight {
  model::Light light;
  Eigen::Vector3d direction_at_reference;                    // from the reference point
  Eigen::Vector3d diffuse_product;                           // O k_d I
  std::array<double, model::kMostLobes> specular_product{};  // k_s I of each lobe
  double inverse_distance_at_reference = 0.0;                // in 1/R
};
struct Reported {
  std::vector<ReportedLight> lights;
  model::Reflectance reflectance;
  Eigen::Vector3d ambient_product;  // O k_a
};

// order[i]: which of the scene's lights is reported as number i.
Reported Report(const model::Scene& solver_scene, const observe::Observations& observations,
                const std::vector<std::size_t>& order);
// Strongest (at W's origin) first.
std::vector<std::size_t> StrengthOrder(const model::Scene& solver_scene,
                                       const observe::Observations& observations);

}  // namespace turnlight::estimator::uncertainty
