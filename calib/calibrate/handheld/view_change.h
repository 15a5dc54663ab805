// Which pictures of a camera that is carried round a target become keyframes: one for each so many
// degrees of view change, as in Mashita et al., "Parallel Lighting and Reflectance Estimation based
// on Inverse Rendering": what lies between tells little new.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/pose.h"

namespace turnlight::calib::calibrate::handheld {

// The unit direction in T from T's origin to the camera. X_TC: the camera's pose.
Eigen::Vector3d ViewDirection(const Pose& X_TC);

class ViewChange {
 public:
  // step_deg: above 0, to 180.
  explicit ViewChange(double step_deg) : step_deg_(step_deg) {}

  // The angle in degrees to the nearest keyframe so far; nothing before the first one.
  std::optional<double> NearestDeg(const Eigen::Vector3d& direction) const;
  // Whether a view from there is a keyframe: the first one, and those that are no nearer than a
  // step to any keyframe before.
  bool IsKeyframe(const Eigen::Vector3d& direction) const;
  void Add(const Eigen::Vector3d& direction) { keyframes_.push_back(direction); }
  const std::vector<Eigen::Vector3d>& keyframes() const { return keyframes_; }

 private:
  double step_deg_;
  std::vector<Eigen::Vector3d> keyframes_;
};

}  // namespace turnlight::calib::calibrate::handheld
