// Where a ball is, from its outline: the rays that touch it form a cone about the way to its
// centre.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "base/result.h"
#include "calib/camera_model.h"

namespace turnlight::calib::calibrate::probe {

struct OutlineBall {
  Eigen::Vector3d center_C = Eigen::Vector3d::Zero();        // in C, length unit of the radius
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  // of it
  double rms_px = 0.0;      // of the points that count, across the outline
  std::size_t points = 0;   // that count
  double share_seen = 0.0;  // of the outline's circumference
};

// Image points between a mask's pixels (non-zero = ball) and others; where the picture ends there
// is no outline.
std::vector<Eigen::Vector2d> MaskOutline(const cv::Mat1b& mask);

// The strongest edge across the outline of a ball that is about where `guess_C` says, every degree
// around it, within a tenth of its size. grey: radiance.
std::vector<Eigen::Vector2d> EdgeOutline(const cv::Mat1f& grey, const CameraModel& camera,
                                         const Eigen::Vector3d& guess_C, double radius);

// A cone through the points; what disagrees (a stand, a hand, a shadow) is left out. `step_px`:
// the uncertainty that all points share, of where an outline is within a step from ball to
// background: it makes the ball larger or smaller. what: begins the messages.
// Fails (kInput): fewer than 20 points, less than a quarter of the circumference, no cone that half
// of the points are on, a centre that is not in front of the camera.
Result<OutlineBall> FitOutline(const std::vector<Eigen::Vector2d>& outline,
                               const CameraModel& camera, double radius, double step_px,
                               const std::string& what);

}  // namespace turnlight::calib::calibrate::probe
