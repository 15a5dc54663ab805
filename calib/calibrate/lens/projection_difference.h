// How far two lens models of one camera project apart.
//
// Two calibrations of one camera differ in where they think its frame C is: part of a difference of
// intrinsics is a rotation that nobody can see. The rotation that brings the projections together
// is fitted and taken off, as mrcal 2.2 does looking at infinity (implied_Rt10__from_unprojections:
// the sum over the pixels of (weight angle^2)^2 is least).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/result.h"
#include "calib/camera_model.h"

namespace turnlight::calib::calibrate::lens {

// Pixels evenly over a picture, the outermost on its edges, row by row.
struct ImageGrid {
  int columns = 0, rows = 0;
  std::vector<Eigen::Vector2d> pixels;
};
// rows follow from the picture's shape; columns is at least 2.
ImageGrid GridOverImage(int width, int height, int columns = 60);

struct LensDifference {
  Eigen::Matrix3d rotation;  // from a's frame C to b's
  // Of each pixel: where b puts what a sees in it, less the pixel. NaN where a lens does not reach.
  std::vector<Eigen::Vector2d> px;
};

// weights of the pixels in the fit, at least 0; one that is not finite counts as 0. Fails (kInput)
// for pictures of two sizes, and where fewer than three pixels count.
Result<LensDifference> ProjectionDifference(const CameraModel& a, const CameraModel& b,
                                            const std::vector<Eigen::Vector2d>& pixels,
                                            const std::vector<double>& weights);

}  // namespace turnlight::calib::calibrate::lens
