// How well a calibration knows where a point projects to, as mrcal 2.2 defines it.
//
// Noise of the corners moves the intrinsics and with them the frame C: part of what the intrinsics
// change is a rotation and a shift of the camera that nobody notices. So a point is held fixed to
// the boards, not to C: the mean over the boards of how noise moves them in C is taken off. At
// infinity only the rotation matters. The noise is that of the residuals.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/camera_model.h"

namespace turnlight::calib::calibrate::lens {

// Larger square root of an eigenvalue: the standard deviation in the worst direction. NaN stays.
double WorstSigma(const Eigen::Matrix2d& covariance);

// Derivatives of the pixels that directions project to: two rows a pixel (x, y), one column for
// each of the intrinsics, then three for a rotation of the direction (rotation vector in C's axes).
// Rows of pixels that the lens does not reach are NaN.
Eigen::MatrixXd PixelDerivatives(const CameraModel& camera,
                                 const std::vector<Eigen::Vector2d>& pixels);

class ProjectionUncertainty {
 public:
  // Of the intrinsics in their order, then of the mean motion of the boards in C: rotation vector
  // (radians, in C's axes) and shift at C's origin (the board's length unit).
  ProjectionUncertainty(CameraModel camera, Eigen::MatrixXd covariance)
      : camera_(std::move(camera)), covariance_(std::move(covariance)) {}

  // Covariance in pixels^2 of where the point at this distance in the direction of a pixel projects
  // to; without a distance: at infinity. NaN where the lens does not reach.
  std::vector<Eigen::Matrix2d> At(const std::vector<Eigen::Vector2d>& pixels,
                                  std::optional<double> distance = std::nullopt) const;

  const CameraModel& camera() const { return camera_; }
  const Eigen::MatrixXd& covariance() const { return covariance_; }

 private:
  CameraModel camera_;
  Eigen::MatrixXd covariance_;
};

}  // namespace turnlight::calib::calibrate::lens
