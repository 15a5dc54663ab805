// Plane to plane, as a pinhole sees it.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace turnlight::calib::calibrate::board {

// The H for which H (from, 1) is proportional to (to, 1), least squares of the algebraic error
// after Hartley's normalisation (In Defense of the Eight-Point Algorithm, 1997). Nothing from fewer
// than four points, or where they do not determine it. weights, if not empty, one for each point.
std::optional<Eigen::Matrix3d> FitHomography(const std::vector<Eigen::Vector2d>& from,
                                             const std::vector<Eigen::Vector2d>& to,
                                             const std::vector<double>& weights = {});

inline Eigen::Vector2d Map(const Eigen::Matrix3d& homography, const Eigen::Vector2d& point) {
  return (homography * point.homogeneous()).hnormalized();
}

}  // namespace turnlight::calib::calibrate::board
