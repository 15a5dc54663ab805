#include "calib/calibrate/handheld/view_change.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/angles.h"

namespace turnlight::calib::calibrate::handheld {

Eigen::Vector3d ViewDirection(const Pose& X_TC) { return X_TC.translation.normalized(); }

std::optional<double> ViewChange::NearestDeg(const Eigen::Vector3d& direction) const {
  std::optional<double> nearest;
  for (const Eigen::Vector3d& keyframe : keyframes_) {
    // Exact for small angles too, where a cosine is not.
    const double angle = std::atan2(keyframe.cross(direction).norm(), keyframe.dot(direction));
    nearest = std::min(nearest.value_or(360.0), RadToDeg(angle));
  }
  return nearest;
}

bool ViewChange::IsKeyframe(const Eigen::Vector3d& direction) const {
  const auto nearest = NearestDeg(direction);
  return !nearest || *nearest >= step_deg_;
}

}  // namespace turnlight::calib::calibrate::handheld
