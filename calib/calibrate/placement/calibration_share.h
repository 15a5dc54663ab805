// What the calibration's own uncertainty does to a placement, to first order. Internal to this
// folder.
#pragma once

#include <Eigen/Core>

#include "calib/calibrate/placement/fit.h"

namespace turnlight::calib::calibrate::placement {

// 8 x 8. inverse: the covariance from the noise alone. The parts of the calibration are taken as
// independent of each other, as its file has it; those without a covariance count as exact.
Eigen::MatrixXd CalibrationShare(const Problem& problem, const Fit& fit,
                                 const Eigen::MatrixXd& inverse);

}  // namespace turnlight::calib::calibrate::placement
