// Where a camera is, from one picture of points in a plane whose places are known: a board, or the
// corners of a flat target.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/result.h"
#include "calib/camera_model.h"
#include "calib/pose.h"

namespace turnlight::calib::calibrate::handheld {

// Frame B of the plane: z = 0.
struct SeenPosition {
  Eigen::Vector2d p_B = Eigen::Vector2d::Zero();
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double spread = 1.0;  // standard deviation relative to the others', above 0
};

struct PlanePose {
  Pose X_CB;
  // 6 x 6, as in rig-calibration.json: of a rotation vector w (radians, in C's axes) and a shift d
  // (length unit), R -> Exp(w) R, t -> t + d.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double rms_px = 0.0;  // per coordinate, of a point of spread 1, with degrees of freedom
  // Points of a plane far away look nearly the same from its mirrored tilt: how much larger the
  // rms would be there. 1 and a little: the tilt is a guess. Infinity: there is no such pose.
  double mirrored_ratio = 0.0;
};

// The pose of least squares of pixels, by the camera's own projection. pixel_sigma: standard
// deviation of a coordinate of spread 1 that is known beforehand; the covariance is by it or by the
// residuals, whichever are larger. Starts from the two solutions of Collins and Bartoli
// (Infinitesimal Plane-Based Pose Estimation, 2014), as OpenCV has them.
// Fails (kInput): fewer than four points, points on a line, a point that the lens does not reach or
// that lies 85 degrees or more off its axis, no pose with all points before the camera.
Result<PlanePose> EstimatePlanePose(const CameraModel& camera,
                                    const std::vector<SeenPosition>& points, double pixel_sigma);

}  // namespace turnlight::calib::calibrate::handheld
