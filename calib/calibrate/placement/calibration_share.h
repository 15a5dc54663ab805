// What the calibration's own uncertainty does to a placement, to first order. Internal to this
// folder and to drift.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/calibrate/placement/fit.h"
#include "calib/rig_geometry.h"

namespace turnlight::calib::calibrate::placement {

// Derivatives of a point in C by the poses and angles of the rig, in their files' parameters; p_A
// turns with the table.
struct ByGeometry {
  Eigen::Matrix<double, 3, 6> X_WC, X_WA;
  Eigen::Vector3d angle_scale, angle_offset;  // by deg/deg and by deg
};
ByGeometry PointByGeometry(const calib::TurntableGeometry& geometry, double angle_deg,
                           const Eigen::Vector3d& p_A);

// Parts of the calibration that have a covariance, X_AT not among them; what the parameters of the
// placement move by theirs.
struct CalibrationShare {
  std::vector<std::string> of;  // keys of the calibration's file
  Eigen::MatrixXd covariance;   // of all of them, in this order, N x N
  Eigen::MatrixXd transfer;     // 8 x N
};

// inverse: the covariance of the parameters from the noise alone. Parts without a covariance count
// as exact, those that are in no joint covariance as independent.
CalibrationShare ShareOfCalibration(const Problem& problem, const Fit& fit,
                                    const Eigen::MatrixXd& inverse);

}  // namespace turnlight::calib::calibrate::placement
