// A board that turns about an axis before a camera: the fit by Ceres, and its linearization. All in
// C, so that nothing is a matter of choice but which way the axis points and at which angle the
// board's pose is told.
//
//   p_C = a + R(u, theta) (X_CB p_B - a),
//   theta = scale (angle - angle_ref + approach backlash / 2) + deviation
//
// Angles in radians. A view's deviation has a normal prior, whose width is `angle_noise` widths of
// the corners' noise.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "base/result.h"
#include "calib/camera_model.h"
#include "calib/pose.h"

namespace turnlight::calib::calibrate::axis {

struct ModelPoint {
  Eigen::Vector3d p_B = Eigen::Vector3d::Zero();
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double spread = 1.0;
};

struct ModelView {
  double angle = 0.0;       // radians from angle_ref, as the table reports it
  double approach = 0.0;    // +1: reached by falling angles, -1: by rising ones
  bool free_angle = false;  // what the table reports of it counts for nothing
  std::vector<ModelPoint> points;
};

struct TurningState {
  Eigen::Vector3d u = Eigen::Vector3d::UnitZ();  // unit
  Eigen::Vector3d a = Eigen::Vector3d::Zero();   // on the axis
  Pose X_CB;                                     // at angle_ref
  double scale = 1.0;
  double backlash = 0.0;           // radians that the table reports
  std::vector<double> deviations;  // of the views, radians
};

// The columns of a linearization: the axis's direction along the basis (2), its point (2), the
// board's rotation vector and shift (6), scale, backlash.
inline constexpr int kDirection = 0, kPoint = 2, kBoardTurn = 4, kBoardShift = 7, kScale = 10,
                     kBacklash = 11, kParameters = 12;
using Step = Eigen::Matrix<double, kParameters, 1>;

// Two unit vectors that with u make a right-handed frame.
Eigen::Matrix<double, 3, 2> AcrossAxis(const Eigen::Vector3d& u);
// The state after a step of the columns, deviations as they are.
TurningState Stepped(const TurningState& state, const Step& step);

// X_CB when the table reports the angle, the view's deviation included.
Pose BoardPose(const TurningState& state, const ModelView& view, double deviation);

// Seen less projected, pixels, of each point, not divided by spread. NaN where the lens does not
// reach.
std::vector<Eigen::Vector2d> Residuals(const TurningState& state, const CameraModel& camera,
                                       const ModelView& view, double deviation);

// Minimises the squared residuals / spread plus (deviation / angle_noise)^2, from state. Fails
// (kNoEstimate) if Ceres finds no minimum.
Status FitTurning(const CameraModel& camera, const std::vector<ModelView>& views,
                  double angle_noise, bool fits_backlash, TurningState& state);

// Of one view's residuals / spread (of point 0 in x, y, then of point 1, ...).
struct ViewLinearization {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd by_step;       // rows x kParameters
  Eigen::VectorXd by_deviation;  // rows
};
ViewLinearization Linearize(const TurningState& state, const CameraModel& camera,
                            const ModelView& view, double deviation);
// Rows x intrinsics, by differences.
Eigen::MatrixXd ByIntrinsics(const TurningState& state, const CameraModel& camera,
                             const ModelView& view, double deviation);

}  // namespace turnlight::calib::calibrate::axis
