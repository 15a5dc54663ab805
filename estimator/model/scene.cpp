#include "estimator/model/scene.h"

#include <algorithm>
#include <cmath>

namespace turnlight::estimator::model {

Light Recentred(const Light& light, const Eigen::Vector3d& new_origin) {
  const Eigen::Vector3d to_light = light.Toward(new_origin);
  const double scale = to_light.norm();
  Light result = light;
  result.direction = to_light / scale;
  result.inverse_distance = light.inverse_distance / scale;
  result.intensity = light.intensity / (scale * scale);
  return result;
}

double DiffuseTerm(const Reflectance& reflectance, const Eigen::Vector3d& normal,
                   const Eigen::Vector3d& to_light, const Eigen::Vector3d& to_viewer) {
  const double nl = normal.dot(to_light);
  if (nl <= 0.0) return 0.0;
  if (reflectance.diffuse_model == DiffuseModel::kLambert) return nl;
  const double variance = reflectance.roughness * reflectance.roughness;
  const double a = 1.0 - 0.5 * variance / (variance + 0.33);
  const double b = 0.45 * variance / (variance + 0.09);
  // cos(difference of azimuths) sin(alpha) tan(beta), alpha the larger angle and beta the smaller,
  // without trigonometry: the first two factors with sin(beta) are l.v - (n.l)(n.v).
  const double nv = normal.dot(to_viewer);
  const double projected = to_light.dot(to_viewer) - nl * nv;
  return nl * (a + b * std::max(projected, 0.0) / std::max(nl, nv));
}

double SpecularTerm(const Reflectance& reflectance, const Eigen::Vector3d& normal,
                    const Eigen::Vector3d& to_light, const Eigen::Vector3d& to_viewer) {
  if (normal.dot(to_light) <= 0.0) return 0.0;
  // The cosine is taken from the chord between the two unit vectors: near 1 the dot product has
  // lost what a large shininess needs.
  switch (reflectance.specular_model) {
    case SpecularModel::kNone:
      return 0.0;
    case SpecularModel::kPhong: {
      const Eigen::Vector3d mirrored = 2.0 * normal.dot(to_viewer) * normal - to_viewer;
      const double half_chord = 0.5 * (to_light - mirrored).squaredNorm();
      return half_chord < 1.0 ? std::exp(reflectance.shininess * std::log1p(-half_chord)) : 0.0;
    }
    case SpecularModel::kBlinnPhong: {
      const Eigen::Vector3d half = (to_light + to_viewer).normalized();
      const double half_chord = 0.5 * (half - normal).squaredNorm();
      return half_chord < 1.0 ? std::exp(reflectance.shininess * std::log1p(-half_chord)) : 0.0;
    }
  }
  return 0.0;
}

double LobeHalfWidth(double shininess) { return std::acos(std::exp2(-1.0 / shininess)); }

Eigen::Vector3d Shade(const Scene& scene, const Eigen::Vector3d& p_W,
                      const Eigen::Vector3d& normal_W, const Eigen::Vector3d& to_viewer_W,
                      LightMask visible) {
  const Reflectance& reflectance = scene.reflectance;
  if (normal_W.dot(to_viewer_W) <= 0.0) return Eigen::Vector3d::Zero();
  Eigen::Vector3d diffuse = Eigen::Vector3d::Zero();
  Eigen::Vector3d specular = Eigen::Vector3d::Zero();
  for (std::size_t l = 0; l < scene.lights.size(); ++l) {
    if ((visible >> l & 1) == 0) continue;
    const Light& light = scene.lights[l];
    const Eigen::Vector3d to_light = light.Toward(p_W);
    const double squared = to_light.squaredNorm();
    const Eigen::Vector3d unit = to_light / std::sqrt(squared);
    const Eigen::Vector3d irradiance = light.intensity / squared * light.color;
    diffuse += irradiance * DiffuseTerm(reflectance, normal_W, unit, to_viewer_W);
    specular += irradiance * SpecularTerm(reflectance, normal_W, unit, to_viewer_W);
  }
  return reflectance.albedo.cwiseProduct(Eigen::Vector3d::Constant(reflectance.ambient) +
                                         reflectance.diffuse * diffuse) +
         reflectance.specular * specular;
}

}  // namespace turnlight::estimator::model
