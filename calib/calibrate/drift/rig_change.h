// How a rig may have changed, as a vector: a step of every number of its calibration, what the
// stored calibration may have wrong, and which of the numbers a cause of drift moves.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "rig/rig_calibration.h"

namespace turnlight::calib::calibrate::drift {

enum class Cause { kCamera, kAngles, kLens, kTarget };
inline constexpr std::array<Cause, 4> kCauses{Cause::kCamera, Cause::kAngles, Cause::kLens,
                                              Cause::kTarget};
// "camera", "angles", "lens", "target"
std::string CauseName(Cause cause);

// Where the parts stand in a step, in the units of rig-calibration.json: intrinsics (all if their
// covariance is known, else the first four), X_WC (w, d), X_WA (w, d), angle_scale, angle_offset
// (degrees), and the pose in A of what stands on the table (w, d): the target, or a board.
struct Layout {
  explicit Layout(const rig::RigCalibration& calibration);
  Eigen::Index intrinsics, X_WC, X_WA, angle_scale, angle_offset, object, size;
};

// The calibration after a step, X_AT being the object's pose.
rig::RigCalibration Changed(const rig::RigCalibration& calibration, const Layout& layout,
                            const Eigen::VectorXd& step);

// The covariance of the stored numbers, S = L L', as L: size x its rank. Parts without a covariance
// count as exact. X_AT's is in it if `with_target`.
Eigen::MatrixXd StoredRoot(const rig::RigCalibration& calibration, const Layout& layout,
                           bool with_target);
// The parts of those that have no covariance in the file, by key.
std::vector<std::string> WithoutCovariance(const rig::RigCalibration& calibration,
                                           bool with_target);

// The steps that a cause makes, a column each, so long as a drift may be that nobody would
// overlook: the camera's turn and shift in W; the angles' scale and offset; focal length (fx and fy
// by one factor) and image centre; the object's turn and shift in A.
Eigen::MatrixXd StepsOf(Cause cause, const rig::RigCalibration& calibration, const Layout& layout);

// From the camera to A's origin, length unit.
double CameraDistance(const rig::RigCalibration& calibration);

}  // namespace turnlight::calib::calibrate::drift
