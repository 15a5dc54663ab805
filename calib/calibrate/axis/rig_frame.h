// The world frame W of a calibrated axis, and what is uncertain in it.
//
// The axis says nothing about where along it W's origin is, and which way x points; the choice is
// this, so that X_WA is the identity and all uncertainty is in X_WC and the scale:
// - z along the axis. If the board lies on the table, more or less (its normal within 45 degrees of
//   the axis), towards the side of it that the camera sees; if it stands, upwards in the picture.
// - The origin where the axis meets the plane of the board; of a standing board at the height of
//   its middle; and origin_height from there along z. A board's plane is above the table by
//   its thickness: -3 for one of 3 mm puts the origin on the table.
// - x so that the camera's centre is at y = 0, x > 0. A camera within 5 degrees of the axis, seen
//   from the origin, has no such side: then x is as downwards in the picture.
#pragma once

#include <Eigen/Core>

#include "calib/calibrate/axis/turning_model.h"
#include "calib/pose.h"

namespace turnlight::calib::calibrate::axis {

// The choices that do not change with small steps of the state.
struct FrameChoice {
  bool board_lies = true;
  bool along_u = true;                                 // z is u, else -u
  bool x_to_camera = true;                             // else downwards in the picture
  Eigen::Vector3d middle_B = Eigen::Vector3d::Zero();  // of the board
  double origin_height = 0.0;
};
FrameChoice ChooseFrame(const TurningState& state, const Eigen::Vector3d& middle_B,
                        double origin_height);

Pose FrameOf(const TurningState& state, const FrameChoice& choice);  // X_WC
// About W's z.
double ScaleIn(const TurningState& state, const FrameChoice& choice);

inline constexpr int kRigParameters = 7;
// Of X_WC (rotation vector w, shift d: R -> Exp(w) R, t -> t + d) and the scale by the columns of
// the linearization.
Eigen::Matrix<double, kRigParameters, kParameters> ByStep(const TurningState& state,
                                                          const FrameChoice& choice);

}  // namespace turnlight::calib::calibrate::axis
