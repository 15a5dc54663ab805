// A mesh that shadows itself: a floor in the plane z = 0 with a wall on it.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "calib/target_shape.h"

namespace turnlight::estimator {

// The floor is 100 x 100 about the origin, seen from above; the wall stands at y = 20 all across
// it, 10 high, and faces -y.
inline calib::MeshShape FloorAndWall() {
  calib::MeshShape mesh;
  const auto quad = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                        const Eigen::Vector3d& c, const Eigen::Vector3d& d) {
    const int at = static_cast<int>(mesh.vertices.size());
    const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
    for (const Eigen::Vector3d& p : {a, b, c, d}) {
      mesh.vertices.push_back(p);
      mesh.normals.push_back(normal);
    }
    mesh.faces.emplace_back(at, at + 1, at + 2);
    mesh.faces.emplace_back(at, at + 2, at + 3);
  };
  quad({-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0});
  quad({-50, 20, 0}, {50, 20, 0}, {50, 20, 10}, {-50, 20, 10});
  return mesh;
}

}  // namespace turnlight::estimator
