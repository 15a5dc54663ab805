// Poses that follow one axis: what a turntable, or a camera carried round, makes of angles.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/rig_geometry.h"

namespace turnlight::estimator::consistency {

struct Turning {
  bool camera_moves = false;                        // else the target does
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  // in W, unit, so that most angles grow
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // in W, on the axis
  std::vector<double> angle;                        // radians, unwrapped, of each keyframe
};

// None if the poses do not follow one axis to 2e-3 (radians, and of the largest distance), if both
// camera and target move, or if they turn by less than 5 degrees. angles_deg, one for each pose or
// empty, are what the session calls them: where the poses follow them, either way round, the angle
// is 0 where they are 0; else it is 0 at the first pose.
std::optional<Turning> FindTurning(const std::vector<calib::RigPoses>& poses,
                                   const std::vector<double>& angles_deg);

// Keyframe k's poses with its angle changed by `by` radians.
calib::RigPoses Turned(const Turning& turning, const calib::RigPoses& poses, double by);

}  // namespace turnlight::estimator::consistency
