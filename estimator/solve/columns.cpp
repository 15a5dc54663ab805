#include "estimator/solve/columns.h"

#include <algorithm>
#include <cmath>

#include "estimator/model/tangent_basis.h"

namespace turnlight::estimator::solve {

Eigen::VectorXd Values(const model::Scene& scene, const Columns& columns) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(columns.count());
  const model::Reflectance& r = scene.reflectance;
  for (int c = 0; c < columns.channels; ++c) out[columns.Albedo(c)] = r.albedo[c];
  out[columns.Ambient()] = r.ambient;
  out[columns.Diffuse()] = r.diffuse;
  out[columns.Specular()] = r.specular;
  out[columns.LogShininess()] = std::log(r.shininess);
  out[columns.RoughnessSquared()] = r.roughness * r.roughness;
  for (int l = 0; l < columns.lights; ++l) {
    const model::Light& light = scene.lights[static_cast<std::size_t>(l)];
    out[columns.Intensity(l)] = light.intensity;
    out[columns.InverseDistance(l)] = light.inverse_distance;
  }
  return out;
}

model::Scene Moved(const model::Scene& scene, const Columns& columns, const Eigen::VectorXd& step) {
  model::Scene out = scene;
  model::Reflectance& r = out.reflectance;
  for (int c = 0; c < columns.channels; ++c) r.albedo[c] += step[columns.Albedo(c)];
  if (columns.channels == 1) r.albedo.setConstant(r.albedo[0]);
  r.ambient += step[columns.Ambient()];
  r.diffuse += step[columns.Diffuse()];
  r.specular += step[columns.Specular()];
  r.shininess *= std::exp(step[columns.LogShininess()]);
  const double squared = r.roughness * r.roughness + step[columns.RoughnessSquared()];
  if (step[columns.RoughnessSquared()] != 0.0) r.roughness = std::sqrt(std::max(squared, 0.0));
  for (int l = 0; l < columns.lights; ++l) {
    model::Light& light = out.lights[static_cast<std::size_t>(l)];
    light.intensity += step[columns.Intensity(l)];
    light.inverse_distance += step[columns.InverseDistance(l)];
    light.direction = (light.direction +
                       model::TangentBasis(light.direction) * step.segment<2>(columns.Tangent(l)))
                          .normalized();
  }
  return out;
}

model::Scene WithinBounds(model::Scene scene) {
  model::Reflectance& r = scene.reflectance;
  r.albedo = r.albedo.cwiseMax(0.0);
  r.ambient = std::max(r.ambient, 0.0);
  r.diffuse = std::max(r.diffuse, 0.0);
  r.specular = std::max(r.specular, 0.0);
  r.shininess = std::clamp(r.shininess, model::kMinShininess, model::kMaxShininess);
  r.roughness = std::clamp(r.roughness, 0.0, kMaxRoughness);
  for (model::Light& light : scene.lights) {
    light.intensity = std::max(light.intensity, 0.0);
    light.inverse_distance = std::clamp(light.inverse_distance, 0.0, kMaxInverseDistance);
  }
  return scene;
}

}  // namespace turnlight::estimator::solve
