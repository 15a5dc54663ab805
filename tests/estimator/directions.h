// Directions at random and the angles between them, for tests of what is found.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/angles.h"
#include "base/random.h"
#include "estimator/model/scene.h"

namespace turnlight::estimator {

inline Eigen::Vector3d RandomUnit(const RandomStream& random, std::uint64_t index) {
  return Eigen::Vector3d(random.Normal(3 * index), random.Normal(3 * index + 1),
                         random.Normal(3 * index + 2))
      .normalized();
}

inline double AngleDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return RadToDeg(std::atan2(a.cross(b).norm(), a.dot(b)));
}

// A unit direction so many degrees from u.
inline Eigen::Vector3d Turned(const Eigen::Vector3d& u, double degrees) {
  return (u + std::tan(DegToRad(degrees)) * u.unitOrthogonal()).normalized();
}

// The largest distance, degrees, of a true light from the nearest found one; 180 if their numbers
// differ.
inline double WorstDirectionDeg(const std::vector<model::Light>& found,
                                const std::vector<model::Light>& truth) {
  if (found.size() != truth.size()) return 180.0;
  double worst = 0.0;
  for (const model::Light& light : truth) {
    double nearest = 180.0;
    for (const model::Light& other : found)
      nearest = std::min(nearest, AngleDeg(other.direction, light.direction));
    worst = std::max(worst, nearest);
  }
  return worst;
}

}  // namespace turnlight::estimator
