// The axis that was found, as parts of a rig's calibration.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "calib/calibrate/axis/calibrate_axis.h"
#include "rig/rig_calibration.h"

namespace turnlight::app {

// Puts X_WC, X_WA and the angles in, with their covariances, as found with the calibration's lens;
// the target's place is not known any more, as W is another. intrinsics_covariance: of the lens,
// what the axis was found with.
void PutAxis(const calib::calibrate::axis::AxisCalibration& axis,
             const std::optional<Eigen::MatrixXd>& intrinsics_covariance,
             rig::RigCalibration& calibration);

}  // namespace turnlight::app
