#include "calib/calibrate/axis/rig_frame.h"

#include <Eigen/Geometry>
#include <cmath>

#include "base/angles.h"

namespace turnlight::calib::calibrate::axis {
namespace {

const double kLies = std::cos(DegToRad(45.0));
const double kBesideAxis = std::sin(DegToRad(5.0));

Eigen::Vector3d ZOf(const TurningState& state, const FrameChoice& choice) {
  return choice.along_u ? state.u : (-state.u).eval();
}

Eigen::Vector3d OriginOf(const TurningState& state, const FrameChoice& choice) {
  const Eigen::Vector3d z = ZOf(state, choice), normal = state.X_CB.rotation.col(2);
  const Eigen::Vector3d away = state.X_CB * choice.middle_B - state.a;
  const double along = choice.board_lies ? normal.dot(away) / normal.dot(z) : z.dot(away);
  return state.a + (along + choice.origin_height) * z;
}

}  // namespace

FrameChoice ChooseFrame(const TurningState& state, const Eigen::Vector3d& middle_B,
                        double origin_height) {
  FrameChoice choice{.middle_B = middle_B, .origin_height = origin_height};
  const Eigen::Vector3d normal = state.X_CB.rotation.col(2);  // either way
  choice.board_lies = std::abs(normal.dot(state.u)) >= kLies;
  // Towards the camera, which is at C's origin; or against C's y axis.
  const Eigen::Vector3d middle = state.X_CB * middle_B;
  const Eigen::Vector3d seen_side = normal.dot(middle) > 0.0 ? (-normal).eval() : normal;
  choice.along_u =
      state.u.dot(choice.board_lies ? seen_side : (-Eigen::Vector3d::UnitY()).eval()) > 0.0;
  const Eigen::Vector3d to_camera = -OriginOf(state, choice);
  choice.x_to_camera = to_camera.cross(state.u).norm() > kBesideAxis * to_camera.norm();
  return choice;
}

Pose FrameOf(const TurningState& state, const FrameChoice& choice) {
  const Eigen::Vector3d z = ZOf(state, choice), origin = OriginOf(state, choice);
  const Eigen::Vector3d side = choice.x_to_camera ? (-origin).eval() : Eigen::Vector3d::UnitY();
  Pose X_CW;
  X_CW.rotation.col(2) = z;
  X_CW.rotation.col(1) = z.cross(side).normalized();
  X_CW.rotation.col(0) = X_CW.rotation.col(1).cross(z);
  X_CW.translation = origin;
  Pose X_WC = X_CW.Inverse();
  if (choice.x_to_camera) X_WC.translation.y() = 0.0;  // it is, but for rounding
  return X_WC;
}

double ScaleIn(const TurningState& state, const FrameChoice& choice) {
  return choice.along_u ? state.scale : -state.scale;
}

Eigen::Matrix<double, kRigParameters, kParameters> ByStep(const TurningState& state,
                                                          const FrameChoice& choice) {
  // Turns in radians and shifts relative to the camera's distance: of the order of 1.
  constexpr double kStep = 1e-6;
  const double distance = (state.X_CB * choice.middle_B).norm();
  const Pose X_CW = FrameOf(state, choice).Inverse();
  Eigen::Matrix<double, kRigParameters, kParameters> by;
  for (int column = 0; column < kParameters; ++column) {
    const bool is_length =
        (column >= kPoint && column < kBoardTurn) || (column >= kBoardShift && column < kScale);
    const double size = kStep * (is_length ? distance : 1.0);
    Eigen::Matrix<double, kRigParameters, 2> moved;
    for (int side = 0; side < 2; ++side) {
      const TurningState there = Stepped(state, (side == 0 ? size : -size) * Step::Unit(column));
      const Pose X_WC = FrameOf(there, choice);
      const Eigen::AngleAxisd turn(X_WC.rotation * X_CW.rotation);
      moved.col(side) << turn.angle() * turn.axis(), X_WC.translation, ScaleIn(there, choice);
    }
    by.col(column) = (moved.col(0) - moved.col(1)) / (2.0 * size);
  }
  return by;
}

}  // namespace turnlight::calib::calibrate::axis
