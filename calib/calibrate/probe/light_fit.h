// One light from the places where a ball shows it: least squares over its direction and inverse
// distance, the model of the estimator, so that a distant light and a near one are one model.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "calib/calibrate/probe/ball.h"

namespace turnlight::calib::calibrate::probe {

// A spot in a view, with what its place is known to.
struct Sighting {
  std::size_t view = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  // pixel^2
};

// About a reference point p: from x the light is seen along u - rho (x - p).
struct LightFit {
  Eigen::Vector3d u = Eigen::Vector3d::UnitZ();
  double rho = 0.0;  // may come out below 0: rays that spread beyond infinity
  // Of steps of u along the columns of Across(u), radians, and of rho. Without rho: its row and
  // column are 0.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double chi_squared = 0.0;
  int freedom = 0;  // degrees; 0: the data cannot say how well they fit
};

// views are those of the sightings; at least one sighting. near: rho is fitted, otherwise it is 0.
// Nothing if a spot misses its ball or the views do not determine what is asked: of a single view
// the distance, and of several that show the same.
std::optional<LightFit> FitLight(const std::vector<BallView>& views,
                                 const std::vector<Sighting>& sightings,
                                 const Eigen::Vector3d& reference, bool near);

}  // namespace turnlight::calib::calibrate::probe
