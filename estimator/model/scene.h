// The scene model (design, section 3): lights, reflectance, and what they make a surface point look
// like. Plain values.
//
//   S_c(x) = O_c * ( k_a + k_d * sum_l I_l a_l(x) f_d ) + k_s * sum_l I_l a_l(x) f_s,
//   l ~ u_l - rho_l x,   a_l(x) = 1 / |u_l - rho_l x|^2
//
// x is relative to W's origin, in the session's length unit.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace turnlight::estimator::model {

// u is the unit direction of the light from W's origin and rho = 1 / distance. rho = 0 is a distant
// light. The position, if rho > 0, is u / rho.
struct Light {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // u, unit
  double inverse_distance = 0.0;                         // rho >= 0, 1 / length unit
  double intensity = 1.0;                                // irradiance at W's origin, >= 0
  Eigen::Vector3d color = Eigen::Vector3d::Ones();       // R, G, B; multiplies the intensity

  // u - rho x: from x towards the light; its length is that from x over that from the origin.
  Eigen::Vector3d Toward(const Eigen::Vector3d& x) const {
    return direction - inverse_distance * x;
  }
};

// The same light seen from a new origin (given in the old coordinates):
// U = u - rho c, s = |U|, u' = U / s, rho' = rho / s, I' = I / s^2.
Light Recentred(const Light& light, const Eigen::Vector3d& new_origin);

enum class DiffuseModel { kLambert, kOrenNayar };
enum class SpecularModel { kNone, kPhong, kBlinnPhong };

// What a lobe may be: from hardly one to narrower than pixels.
inline constexpr double kMinShininess = 0.5;
inline constexpr double kMaxShininess = 1e5;

struct Reflectance {
  Eigen::Vector3d albedo = Eigen::Vector3d::Ones();  // O, R G B
  double ambient = 0.0;                              // k_a
  double diffuse = 1.0;                              // k_d
  double specular = 0.0;                             // k_s
  double shininess = 1.0;                            // n, kMinShininess to kMaxShininess
  DiffuseModel diffuse_model = DiffuseModel::kLambert;
  double roughness = 0.0;  // Oren-Nayar's sigma, radians of facet slope; 0 is Lambert
  SpecularModel specular_model = SpecularModel::kPhong;
};

struct Scene {
  std::vector<Light> lights;
  Reflectance reflectance;
};

// f_d of the diffuse model for unit vectors: Lambert n.l, or the qualitative model of Oren and
// Nayar, "Generalization of Lambert's Reflectance Model" (SIGGRAPH 1994), its factor 1/pi left out.
double DiffuseTerm(const Reflectance& reflectance, const Eigen::Vector3d& normal,
                   const Eigen::Vector3d& to_light, const Eigen::Vector3d& to_viewer);
// f_s of the specular model: Phong (r.v)^n, r mirroring l about the normal; Blinn-Phong (n.h)^n;
// both un-normalised and without a factor n.l; or 0.
double SpecularTerm(const Reflectance& reflectance, const Eigen::Vector3d& normal,
                    const Eigen::Vector3d& to_light, const Eigen::Vector3d& to_viewer);

// The half-width of a lobe cos^n, radians: acos(2^(-1/n)).
double LobeHalfWidth(double shininess);

// At most this many lights in a scene: one bit each says which of them a point sees.
inline constexpr std::size_t kMaxLights = 64;
using LightMask = std::uint64_t;
inline constexpr LightMask kAllLights = ~LightMask{0};

// Radiance (R, G, B) of a point seen along to_viewer (unit, away from the surface); 0 where the
// viewer is below the surface. Lights whose bit of `visible` is 0 are left out (cast shadow).
Eigen::Vector3d Shade(const Scene& scene, const Eigen::Vector3d& p_W,
                      const Eigen::Vector3d& normal_W, const Eigen::Vector3d& to_viewer_W,
                      LightMask visible = kAllLights);

}  // namespace turnlight::estimator::model
