#include "estimator/uncertainty/photograph_errors.h"

#include <cmath>

#include "estimator/observe/observation_access.h"

namespace turnlight::estimator::uncertainty {
namespace {

constexpr double kPlace = 0.15;            // pixels
constexpr double kInverseDistance = 0.02;  // 1/R

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
      const double cosine = observe::At(all.mirrored, i).dot(light.direction);
      if (cosine > best) {
        best = cosine;
        at = i;
      }
    }
    const double turn = all.size() > 0
                            ? std::sqrt(0.5 * (observe::At(all.footprint, 0, at).squaredNorm() +
                                               observe::At(all.footprint, 3, at).squaredNorm()))
                            : 0.0;
    out.place.push_back(kPlace * turn);
    Eigen::Vector3d across = Eigen::Vector3d::Zero();
    if (all.size() > 0 && light.inverse_distance == 0.0) {
      const Eigen::Vector3d from_origin = observe::At(all.position, at) - origin;
      across = from_origin - light.direction * light.direction.dot(from_origin);
    }
    out.distance.push_back(kInverseDistance * across);
  }
  return out;
}

}  // namespace turnlight::estimator::uncertainty
