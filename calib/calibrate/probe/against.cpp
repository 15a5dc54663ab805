#include "calib/calibrate/probe/against.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/angles.h"
#include "base/format.h"
#include "base/strict_object.h"
#include "calib/calibrate/probe/ball.h"

namespace turnlight::calib::calibrate::probe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kAgreeSigmas = 3.0;
constexpr double kPartnersDeg = 15.0;

std::optional<double> KnownNumber(StrictObject& object, const std::string& key, Range range = {}) {
  if (object.Has(key) && object.Raw(key).is_null()) return std::nullopt;
  return object.OptionalNumber(key, range);
}

std::optional<std::vector<double>> KnownNumbers(StrictObject& object, const std::string& key) {
  if (object.Has(key) && object.Raw(key).is_null()) return std::nullopt;
  return object.OptionalNumbers(key, 3);
}

Result<StatedLight> ReadStated(StrictObject object) {
  StatedLight light;
  const std::vector<double> direction = object.Numbers("direction", 3);
  light.direction = Vector3d(direction[0], direction[1], direction[2]);
  if (object.ok() && !(light.direction.stableNorm() > 1e-100))
    object.RefuseText("direction", "it has no length, allowed is any other vector");
  light.direction.stableNormalize();
  light.direction_sigma =
      DegToRad(KnownNumber(object, "direction_sigma_deg", {.min = 0.0}).value_or(0.0));
  light.distance = KnownNumber(object, "distance", {.above = 0.0});
  light.distance_sigma = KnownNumber(object, "distance_sigma", {.min = 0.0});
  light.distance_min = KnownNumber(object, "distance_min", {.min = 0.0});
  if (const auto position = KnownNumbers(object, "position")) {
    light.position = Vector3d((*position)[0], (*position)[1], (*position)[2]);
    if (!light.distance) light.distance = light.position->norm();
  }
  if (object.Has("position_covariance") && !object.Raw("position_covariance").is_null()) {
    const std::vector<double> rows = object.Matrix("position_covariance", 3, 3);
    if (object.ok())
      light.position_covariance =
          Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows.data());
  }
  if (!light.position && light.distance) light.position = *light.distance * light.direction;
  object.AllowUnknown();
  if (const Status status = object.Finish(); !status) return Forward(status);
  return light;
}

double AngleBetween(const Vector3d& a, const Vector3d& b) {
  return 2.0 * std::asin(std::min(1.0, 0.5 * (a - b).norm()));
}

// As seen from a point of W: a direction and its tangent covariance.
struct SeenFrom {
  Vector3d direction;
  Matrix3d covariance;
};

SeenFrom See(const StatedLight& light, const Vector3d& point) {
  if (!light.position) {
    const Matrix3d tangent = Matrix3d::Identity() - light.direction * light.direction.transpose();
    return {light.direction, light.direction_sigma * light.direction_sigma * tangent};
  }
  const Vector3d toward = *light.position - point;
  const double distance = toward.norm();
  const Vector3d u = toward / distance;
  const Matrix3d tangent = Matrix3d::Identity() - u * u.transpose();
  if (light.position_covariance)
    return {u, tangent * *light.position_covariance * tangent / (distance * distance)};
  return {u, light.direction_sigma * light.direction_sigma * tangent};
}

// Across the ball's direction, in sigmas of both; each pair of partners is one draw of two
// components, so its length is compared with the sigma along it.
double AngleSigmas(const ProbeLight& light, const SeenFrom& stated) {
  const Vector3d off = stated.direction - light.direction_at_reference;
  if (!(off.norm() > 0.0)) return 0.0;
  const Vector3d along = off.normalized();
  const double variance = along.dot((light.reference_covariance + stated.covariance) * along);
  return off.norm() / std::sqrt(std::max(variance, 1e-30));
}

void CompareDistance(const ProbeLight& light, const StatedLight& stated, const std::string& unit,
                     LightAgreement& pair) {
  const auto known = light.near ? std::optional(1.0 / light.inverse_distance) : std::nullopt;
  if (known && stated.distance) {
    pair.distance = *stated.distance - *known;
    const double sigma = std::hypot(light.sigma.distance, stated.distance_sigma.value_or(0.0));
    pair.distance_sigmas = std::abs(*pair.distance) / std::max(sigma, 1e-12 * *known);
    pair.agrees = pair.agrees && *pair.distance_sigmas <= kAgreeSigmas;
    pair.words += Format("; distances differ by %.3g", *pair.distance) + " " + unit +
                  Format(", %.1f sigmas", *pair.distance_sigmas);
    return;
  }
  const auto bound = known ? stated.distance_min : light.distance_min;
  const auto distance = known ? known : stated.distance;
  const double sigma = known ? light.sigma.distance : stated.distance_sigma.value_or(0.0);
  if (!bound || !distance) {
    pair.words += "; distances cannot be compared";
    return;
  }
  const bool within = *distance + kAgreeSigmas * sigma >= *bound;
  pair.agrees = pair.agrees && within;
  pair.words += Format("; its distance of %.4g", *distance) + " " + unit +
                (within ? " is" : " is not") + Format(" beyond the bound of %.4g", *bound) + " " +
                unit;
}

LightAgreement ComparePair(const std::vector<ProbeLight>& lights, std::size_t light,
                           const std::vector<StatedLight>& stated, std::size_t partner,
                           const std::string& unit) {
  LightAgreement pair{light, partner, 0.0, 0.0, {}, {}, false, ""};
  const SeenFrom seen = See(stated[partner], lights[light].reference);
  pair.angle = AngleBetween(seen.direction, lights[light].direction_at_reference);
  pair.angle_sigmas = AngleSigmas(lights[light], seen);
  pair.agrees = pair.angle_sigmas <= kAgreeSigmas;
  pair.words = Format("%.3g deg apart, %.1f sigmas", RadToDeg(pair.angle), pair.angle_sigmas);
  CompareDistance(lights[light], stated[partner], unit, pair);
  pair.words =
      Format("light %zu and %zu %s: ", light + 1, partner + 1, pair.agrees ? "agree" : "differ") +
      pair.words;
  return pair;
}

}  // namespace

Result<std::vector<StatedLight>> ReadStatedLights(const std::string& text,
                                                  const std::string& file) {
  const auto document = ParseJson(text, file);
  if (!document) return Forward(document);
  StrictObject object(*document);
  std::vector<StatedLight> lights;
  for (StrictObject& entry : object.Objects("lights", 0)) {
    auto light = ReadStated(std::move(entry));
    if (!light) return Forward(light);
    lights.push_back(*light);
  }
  object.AllowUnknown();
  if (const Status status = object.Finish(); !status) return Forward(status);
  return lights;
}

Agreement CompareLights(const std::vector<ProbeLight>& lights,
                        const std::vector<StatedLight>& stated, const std::string& length_unit) {
  struct Pair {
    double angle;
    std::size_t light, stated;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < lights.size(); ++i)
    for (std::size_t k = 0; k < stated.size(); ++k)
      pairs.push_back({AngleBetween(See(stated[k], lights[i].reference).direction,
                                    lights[i].direction_at_reference),
                       i, k});
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.angle < b.angle; });
  Agreement agreement;
  std::vector<bool> has_partner(lights.size()), is_partner(stated.size());
  for (const Pair& pair : pairs) {
    if (RadToDeg(pair.angle) > kPartnersDeg || has_partner[pair.light] || is_partner[pair.stated])
      continue;
    has_partner[pair.light] = is_partner[pair.stated] = true;
    agreement.lights.push_back(ComparePair(lights, pair.light, stated, pair.stated, length_unit));
  }
  for (std::size_t i = 0; i < lights.size(); ++i)
    if (!has_partner[i])
      agreement.lights.push_back(
          {i, {}, 0.0, 0.0, {}, {}, false, Format("light %zu of the ball is not there", i + 1)});
  for (std::size_t k = 0; k < stated.size(); ++k)
    if (!is_partner[k])
      agreement.lights.push_back(
          {{}, k, 0.0, 0.0, {}, {}, false, Format("its light %zu is not seen in the ball", k + 1)});
  for (const LightAgreement& pair : agreement.lights)
    agreement.agrees = agreement.agrees && pair.agrees;
  return agreement;
}

}  // namespace turnlight::calib::calibrate::probe
