// The shape of a target in its own frame T, as a value: what the session declares and the estimator
// traces. Lengths in the session's unit.
#pragma once

#include <Eigen/Core>
#include <variant>
#include <vector>

namespace turnlight::calib {

struct SphereShape {
  double radius = 1.0;  // positive; centre at T's origin
};

// A rectangle in T's xy plane, centred at the origin, normal +z.
struct PlaneShape {
  double width = 1.0;   // along x, positive
  double height = 1.0;  // along y, positive
  int sides = 1;        // 1: seen and lit from +z only; 2: both
};

struct MeshShape {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3d> normals;  // unit, one per vertex
  std::vector<Eigen::Vector3i> faces;    // counter-clockwise seen from outside
  bool normals_made = false;             // from the faces: whoever gave the shape gave none
};

using TargetShape = std::variant<SphereShape, PlaneShape, MeshShape>;

}  // namespace turnlight::calib
