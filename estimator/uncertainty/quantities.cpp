#include "estimator/uncertainty/quantities.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "estimator/model/tangent_basis.h"

namespace turnlight::estimator::uncertainty {
namespace {

constexpr auto kLobes = static_cast<Eigen::Index>(model::kMostLobes);

// One quantity of a light. `sigma` is where its standard deviations go; none where they are of a
// matrix.
struct LightRow {
  OfLight quantity;
  Eigen::Index size;
  void (*read)(const ReportedLight& light, const ReportedLight& at, double* out);
  double* (*sigma)(LightSigma& out);
};

void Put(const Eigen::Vector3d& value, double* out) { std::copy(value.begin(), value.end(), out); }

constexpr LightRow kLightRows[] = {
    {OfLight::kDirection, 2,
     [](const ReportedLight& light, const ReportedLight& at, double* out) {
       const Eigen::Vector2d tangent =
           model::TangentBasis(at.light.direction).transpose() * light.light.direction;
       out[0] = tangent.x();
       out[1] = tangent.y();
     },
     nullptr},
    {OfLight::kInverseDistance, 1,
     [](const ReportedLight& light, const ReportedLight&, double* out) {
       out[0] = light.light.inverse_distance;
     },
     [](LightSigma& out) { return &out.inverse_distance; }},
    {OfLight::kIntensity, 1,
     [](const ReportedLight& light, const ReportedLight&, double* out) {
       out[0] = light.light.intensity;
     },
     [](LightSigma& out) { return &out.intensity; }},
    {OfLight::kDiffuseProduct, 3,
     [](const ReportedLight& light, const ReportedLight&, double* out) {
       Put(light.diffuse_product, out);
     },
     [](LightSigma& out) { return out.diffuse_product.data(); }},
    {OfLight::kSpecularProduct, kLobes,
     [](const ReportedLight& light, const ReportedLight&, double* out) {
       std::copy(light.specular_product.begin(), light.specular_product.end(), out);
     },
     [](LightSigma& out) { return out.specular_product.data(); }},
    {OfLight::kPosition, 3,
     [](const ReportedLight& light, const ReportedLight& at, double* out) {
       const bool near = at.light.inverse_distance > 0.0;
       Put(light.light.direction / (near ? light.light.inverse_distance : 1.0), out);
     },
     nullptr},
    {OfLight::kDistance, 1,
     [](const ReportedLight& light, const ReportedLight& at, double* out) {
       out[0] = 1.0 / (at.light.inverse_distance > 0.0 ? light.light.inverse_distance : 1.0);
     },
     [](LightSigma& out) { return &out.distance; }},
    {OfLight::kInverseDistanceAtReference, 1,
     [](const ReportedLight& light, const ReportedLight&, double* out) {
       out[0] = light.inverse_distance_at_reference;
     },
     [](LightSigma& out) { return &out.inverse_distance_at_reference; }},
    {OfLight::kColour, 3,
     [](const ReportedLight& light, const ReportedLight&, double* out) {
       Put(light.light.color, out);
     },
     [](LightSigma& out) { return out.colour.data(); }},
};

struct TargetRow {
  OfTarget quantity;
  Eigen::Index size;
  void (*read)(const Reported& reported, double* out);
  double* (*sigma)(Uncertainty& out);
};

constexpr TargetRow kTargetRows[] = {
    {OfTarget::kAlbedo, 3,
     [](const Reported& reported, double* out) { Put(reported.reflectance.albedo, out); },
     [](Uncertainty& out) { return out.albedo.data(); }},
    {OfTarget::kAmbient, 1,
     [](const Reported& reported, double* out) { out[0] = reported.reflectance.ambient; },
     [](Uncertainty& out) { return &out.ambient; }},
    {OfTarget::kDiffuse, 1,
     [](const Reported& reported, double* out) { out[0] = reported.reflectance.diffuse; },
     [](Uncertainty& out) { return &out.diffuse; }},
    {OfTarget::kLobes, 3 * kLobes,
     [](const Reported& reported, double* out) {
       for (const model::Lobe& lobe : reported.reflectance.lobes) {
         *out++ = lobe.strength;
         *out++ = lobe.shape;
         *out++ = lobe.f0;
       }
     },
     [](Uncertainty& out) { return &out.lobes[0].strength; }},
    {OfTarget::kRoughness, 1,
     [](const Reported& reported, double* out) { out[0] = reported.reflectance.roughness; },
     [](Uncertainty& out) { return &out.roughness; }},
    {OfTarget::kAmbientProduct, 3,
     [](const Reported& reported, double* out) { Put(reported.ambient_product, out); },
     [](Uncertainty& out) { return out.ambient_product.data(); }},
    {OfTarget::kHarmonics, model::kHarmonics,
     [](const Reported& reported, double* out) {
       const auto& harmonics = reported.reflectance.harmonics;
       std::copy(harmonics.begin(), harmonics.end(), out);
     },
     [](Uncertainty& out) { return out.harmonics.data(); }},
    {OfTarget::kAmbientColour, 3,
     [](const Reported& reported, double* out) { Put(reported.reflectance.ambient_colour, out); },
     [](Uncertainty& out) { return out.ambient_colour.data(); }},
    {OfTarget::kSpecularColour, 3,
     [](const Reported& reported, double* out) { Put(reported.reflectance.specular_colour, out); },
     [](Uncertainty& out) { return out.specular_colour.data(); }},
};
static_assert(sizeof(LobeSigma) == 3 * sizeof(double), "strength, shape, F0 side by side");

// Where a row of a table begins.
template <typename Rows, typename Quantity>
constexpr Eigen::Index Begin(const Rows& rows, Quantity quantity) {
  Eigen::Index begin = 0;
  for (const auto& row : rows) {
    if (row.quantity == quantity) break;
    begin += row.size;
  }
  return begin;
}

template <typename Rows>
constexpr Eigen::Index All(const Rows& rows) {
  Eigen::Index sum = 0;
  for (const auto& row : rows) sum += row.size;
  return sum;
}

constexpr Eigen::Index kPerLight = All(kLightRows), kOfTarget = All(kTargetRows);

Eigen::Index BeginOf(std::size_t light) { return kPerLight * static_cast<Eigen::Index>(light); }

}  // namespace

Eigen::Index At(OfLight quantity, std::size_t light) {
  return BeginOf(light) + Begin(kLightRows, quantity);
}

Eigen::Index At(OfTarget quantity, std::size_t lights) {
  return BeginOf(lights) + Begin(kTargetRows, quantity);
}

Eigen::Index SizeOf(OfLight quantity) {
  return kLightRows[static_cast<std::size_t>(quantity)].size;
}

Eigen::Index SizeOf(OfTarget quantity) {
  return kTargetRows[static_cast<std::size_t>(quantity)].size;
}

Eigen::Index CountOfQuantities(std::size_t lights) { return BeginOf(lights) + kOfTarget; }

Eigen::VectorXd Flatten(const Reported& reported, const Reported& at) {
  Eigen::VectorXd out(CountOfQuantities(reported.lights.size()));
  double* to = out.data();
  for (std::size_t l = 0; l < reported.lights.size(); ++l)
    for (const LightRow& row : kLightRows) {
      row.read(reported.lights[l], at.lights[l], to);
      to += row.size;
    }
  for (const TargetRow& row : kTargetRows) {
    row.read(reported, to);
    to += row.size;
  }
  return out;
}

void TakeSigmas(const Eigen::MatrixXd& covariance, const std::vector<bool>& unknown,
                std::size_t lights, Uncertainty& out) {
  Eigen::Index q = 0;
  const auto take = [&](Eigen::Index size, double* to) {
    for (Eigen::Index i = 0; i < size; ++i, ++q)
      if (to != nullptr)
        to[i] = unknown[static_cast<std::size_t>(q)] ? std::numeric_limits<double>::quiet_NaN()
                                                     : std::sqrt(std::max(covariance(q, q), 0.0));
  };
  out.lights.resize(lights);
  for (LightSigma& light : out.lights)
    for (const LightRow& row : kLightRows) take(row.size, row.sigma ? row.sigma(light) : nullptr);
  for (const TargetRow& row : kTargetRows) take(row.size, row.sigma(out));
}

}  // namespace turnlight::estimator::uncertainty
