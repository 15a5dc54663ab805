// The scene model (design, section 3): lights, reflectance, and what they make a surface point look
// like. Plain values.
//
//   S_c(x) = O_c * ( k_a(n) A_c + k_d * sum_l I_l C_lc a_l(x) f_d )
//          + s_c * sum_k k_s,k * sum_l I_l C_lc a_l(x) f_s,k,
//   k_a(n) = k_a + sum_j h_j Y_j(n)
//   l ~ u_l - rho_l x,   a_l(x) = 1 / |u_l - rho_l x|^2
//
// x is relative to W's origin, in the session's length unit.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "estimator/model/reflectance/terms.h"
#include "estimator/model/spherical_harmonics.h"

namespace turnlight::estimator::model {

// u is the unit direction of the light from W's origin and rho = 1 / distance. rho = 0 is a distant
// light. The position, if rho > 0, is u / rho.
struct Light {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // u, unit
  double inverse_distance = 0.0;                         // rho >= 0, 1 / length unit
  double intensity = 1.0;                                // irradiance at W's origin, >= 0
  Eigen::Vector3d color = Eigen::Vector3d::Ones();       // R, G, B; multiplies the intensity
  // What multiplies the intensity in each keyframe, >= 0, mean 1 over those that see the light;
  // empty: 1 in all.
  std::vector<double> factors{};

  // u - rho x: from x towards the light; its length is that from x over that from the origin.
  Eigen::Vector3d Toward(const Eigen::Vector3d& x) const {
    return direction - inverse_distance * x;
  }
};

// Irradiance at W's origin, mean of the channels.
inline double Strength(const Light& light) { return light.intensity * light.color.mean(); }

// The same light seen from a new origin (given in the old coordinates):
// U = u - rho c, s = |U|, u' = U / s, rho' = rho / s, I' = I / s^2.
Light Recentred(const Light& light, const Eigen::Vector3d& new_origin);

// As reflectance/models.h numbers them; a lobe's number is one less.
enum class DiffuseModel { kLambert, kOrenNayar, kCoated };
enum class SpecularModel { kNone, kPhong, kBlinnPhong, kBeckmann, kGgx };

// The least F0 of a physical lobe: at 0 it would reflect nothing straight on, and nothing could be
// said of its strength there.
inline constexpr double kLeastF0 = 0.01;

// One lobe: k_s f_s of the design. See reflectance/ for the formulas.
struct Lobe {
  SpecularModel model = SpecularModel::kNone;
  double strength = 0.0;  // k_s >= 0
  double shape = 1.0;     // the exponent n, or the roughness alpha; within the model's facts
  double f0 = 1.0;  // of a physical lobe: F at normal incidence, kLeastF0 to 1 (F = 1 everywhere)

  bool present() const { return model != SpecularModel::kNone; }
};
inline constexpr std::size_t kMostLobes = 2;

struct Reflectance {
  Eigen::Vector3d albedo = Eigen::Vector3d::Ones();  // O, R G B
  double ambient = 0.0;                              // k_a
  // h: how the ambient light depends on the normal, by spherical_harmonics.h; 0: not at all.
  Eigen::Matrix<double, kHarmonics, 1> harmonics = Eigen::Matrix<double, kHarmonics, 1>::Zero();
  double diffuse = 1.0;  // k_d
  DiffuseModel diffuse_model = DiffuseModel::kLambert;
  double roughness = 0.0;  // Oren-Nayar's sigma, radians of facet slope; 0 is Lambert
  // d: how the diffuse part departs from its model with the normal, as a share of it: f_d (1 +
  // sum_j d_j Y_j(n)) by spherical_harmonics.h. What real surfaces have and no model; 0: nothing.
  Eigen::Matrix<double, kHarmonics, 1> shading = Eigen::Matrix<double, kHarmonics, 1>::Zero();
  // Of the ambient light and of what the lobes reflect, R G B, the largest 1: white unless lights
  // are coloured.
  Eigen::Vector3d ambient_colour = Eigen::Vector3d::Ones();
  Eigen::Vector3d specular_colour = Eigen::Vector3d::Ones();
  // The second is there only beside the first.
  std::array<Lobe, kMostLobes> lobes{Lobe{SpecularModel::kPhong}, Lobe{}};
};

// How far all lights are from a point: what is known beside the pictures.
struct DistanceRange {
  // Length unit; least is 0 where nothing is known.
  double least = 0.0, most = std::numeric_limits<double>::infinity();
  Eigen::Vector3d from = Eigen::Vector3d::Zero();

  bool known() const { return least > 0.0; }
};

struct Scene {
  std::vector<Light> lights;
  Reflectance reflectance;
  // For a fit: the colours of lights, ambient light and highlights are unknowns; else all are as
  // they stand. Pictures tell them up to one colour, which white_light is said to have:
  // white (see uncertainty/reported.h).
  bool free_colours = false;
  // Which light is said to be white where colours are fitted: of those in the order of their
  // strength the one with this index.
  std::size_t white_light = 0;
  // For a fit: the lights' factors are unknowns (see solve/frame_factors.h), the ambient light's
  // harmonics are, and the diffuse part's departures are.
  bool free_factors = false, free_harmonics = false, free_shading = false;
  // For a fit: the bounds of the lights' distances.
  DistanceRange distance{};

  // Whether any colour but the albedo is not white.
  bool coloured() const;
  // Whether any light changes from keyframe to keyframe.
  bool flickers() const;
};

// The same scene with every colour's largest channel 1, what it multiplies taking the rest.
Scene WithLargestColoursOne(Scene scene);

// The scene as one keyframe sees it: intensities times their factors there, and no factors.
Scene AtKeyframe(const Scene& scene, std::size_t keyframe);
// The same scene under constant lights.
Scene WithoutFactors(Scene scene);
// The same without ambient light.
Scene WithoutAmbient(Scene scene);

// k_a(n) for a unit normal.
double AmbientTerm(const Reflectance& reflectance, const Eigen::Vector3d& normal);
// f_d of the diffuse model with its departures, for unit vectors; 0 where the light is below the
// surface.
double DiffuseTerm(const Reflectance& reflectance, const Eigen::Vector3d& normal,
                   const Eigen::Vector3d& to_light, const Eigen::Vector3d& to_viewer);
// f_s of one lobe; 0 without one.
double SpecularTerm(const Lobe& lobe, const Eigen::Vector3d& normal,
                    const Eigen::Vector3d& to_light, const Eigen::Vector3d& to_viewer);

// What is known of a model besides its formula. The lobe's is not kNone.
const reflectance::LobeFacts& FactsOf(SpecularModel model);
const reflectance::DiffuseFacts& FactsOf(DiffuseModel model);

// The angle between a lobe's axis (the mirrored view, or the normal) and what it is compared with
// (the light, or the half vector) at which half of its peak is left, radians; without a model that
// of Phong.
double LobeHalfWidth(const Lobe& lobe);
// The same of the mirrored view against the light: twice as much about the normal.
double MirroredHalfWidth(const Lobe& lobe);
// One over the variance of the first angle, of the Gaussian with the same curvature at the peak.
double LobeInverseVariance(const Lobe& lobe);
// What a relative change of the inverse variance of a lobe of the same energy changes, for each
// unit: the logarithm of its shape, and its strength.
struct LobeSlopes {
  double log_shape, strength;
};
LobeSlopes LobeSlopesOf(const Lobe& lobe);
// k_s f_s where the viewer looks straight at the mirrored light, at normal incidence.
double LobePeak(const Lobe& lobe);
// The lobe, so many times as wide and as bright at its peak.
Lobe OfWidth(const Lobe& lobe, double times);
// A lobe of another model that is as wide and as bright at its peak. What has no model counts as
// Phong. Of what is not physical F0 is 1.
Lobe Converted(const Lobe& lobe, SpecularModel model);
// Converts the first lobe, unless it is of that model. Without a first there is no second.
void SetLobeModel(Reflectance& reflectance, SpecularModel model);

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
