// Rigid transforms between frames. X_AB takes B's coordinates to A's: p_AQ = X_AB * p_BQ.
// Frames: W world (lights live here), T target, C camera (x right, y down, z forward).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "base/result.h"

namespace turnlight::calib {

// A proper rigid transform: rotation orthonormal to 1e-6 with determinant +1, finite translation in
// the session's length unit.
struct Pose {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return rotation * p + translation; }
  Pose operator*(const Pose& other) const {
    return {rotation * other.rotation, rotation * other.translation + translation};
  }
  Pose Inverse() const { return {rotation.transpose(), -(rotation.transpose() * translation)}; }
};

// The three rows [R | t] of a pose, 12 numbers row by row. Fails (kInput) with the measured and the
// allowed value: a number that is not finite, a rotation not orthonormal to 1e-6, a reflection
// (determinant -1). `what` begins the message, such as "session.json: frames/3/X_WC".
Result<Pose> PoseFromRows(const std::vector<double>& rows, const std::string& what);

// The inverse of PoseFromRows.
std::vector<double> RowsFromPose(const Pose& pose);

}  // namespace turnlight::calib
