#include "app/calibrate/axis_parts.h"

namespace turnlight::app {
namespace {

// Of a lens with more intrinsics the file would be larger than a person wants to open.
constexpr std::size_t kMostIntrinsicsInFile = 64;

}  // namespace

void PutAxis(const calib::calibrate::axis::AxisCalibration& axis,
             const std::optional<Eigen::MatrixXd>& intrinsics_covariance,
             rig::RigCalibration& calibration) {
  calibration.geometry = {};
  calibration.geometry.X_WC = axis.X_WC;
  calibration.geometry.angle_scale = axis.angle_scale;
  calibration.target_placed = false;
  rig::MarkFound(calibration, {"X_WC", "X_WA", "angle_scale", "angle_offset"});
  rig::CalibrationCovariances& known = calibration.covariances;
  known.X_WC = axis.covariance.topLeftCorner(6, 6);
  known.X_WA = Eigen::MatrixXd::Zero(6, 6);  // by choice of W
  known.angle_scale = axis.covariance.bottomRightCorner(1, 1);
  known.angle_offset = Eigen::MatrixXd::Zero(1, 1);
  known.joint = rig::JointCovariance{{"X_WC", "angle_scale"}, axis.covariance};
  if (!axis.joint_covariance || calibration.lens.intrinsics().size() > kMostIntrinsicsInFile)
    return;
  known.camera_model = intrinsics_covariance;
  known.joint =
      rig::JointCovariance{{"camera_model", "X_WC", "angle_scale"}, *axis.joint_covariance};
}

}  // namespace turnlight::app
