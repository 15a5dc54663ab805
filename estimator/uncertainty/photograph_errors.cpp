#include "estimator/uncertainty/photograph_errors.h"

#include <cmath>

namespace turnlight::estimator::uncertainty {
namespace {

constexpr double kPlace = 0.15;            // pixels
constexpr double kInverseDistance = 0.02;  // 1/R

Eigen::Vector3d At(const std::array<std::vector<float>, 3>& plane, std::size_t i) {
  return {static_cast<double>(plane[0][i]), static_cast<double>(plane[1][i]),
          static_cast<double>(plane[2][i])};
}

}  // namespace

PhotographErrors ErrorsOfHighlights(const observe::Observations& all, const model::Scene& scene) {
  PhotographErrors out;
  const Eigen::Vector3d origin = -all.reference / all.radius;
  for (const model::Light& light : scene.lights) {
    // The pixel that mirrors best.
    std::size_t at = 0;
    double best = -2.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all.pixel[i] == observe::Observations::kNoPixel) continue;
      const double cosine = At(all.mirrored, i).dot(light.direction);
      if (cosine > best) {
        best = cosine;
        at = i;
      }
    }
    double square = 0.0;
    for (std::size_t k = 0; k < 6 && all.size() > 0; ++k)
      square += std::pow(static_cast<double>(observe::FromBFloat16(all.footprint[k][at])), 2);
    const double turn = std::sqrt(0.5 * square);
    out.place.push_back(kPlace * turn);
    Eigen::Vector3d across = Eigen::Vector3d::Zero();
    if (all.size() > 0 && light.inverse_distance == 0.0) {
      const Eigen::Vector3d from_origin = At(all.position, at) - origin;
      across = from_origin - light.direction * light.direction.dot(from_origin);
    }
    out.distance.push_back(kInverseDistance * across);
  }
  return out;
}

}  // namespace turnlight::estimator::uncertainty
