// What a pixel means: a lens model of mrcal, and the rays of its pixels.
//
// Every lens model that mrcal reads is projected and unprojected by mrcal itself; where mrcal's own
// unprojection does not support a model (CAHVORE), its projection is inverted numerically. A ray
// counts only if mrcal projects it back to its pixel. Pixel (0, 0) is the centre of the top-left
// pixel, as in mrcal.
//
// The model is central: all rays start at the origin of C. CAHVORE's entrance pupil moves with the
// angle (its last three intrinsics); it is taken as mrcal 2.2 does, the same at every distance.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "base/result.h"

namespace turnlight::calib {

class CameraModel {
 public:
  // Parses the text of a .cameramodel. The extrinsics in it are ignored. Fails (kInput) with file,
  // key, value and what is allowed: a syntax error, a missing key, an unknown lens model, a wrong
  // number of intrinsics, a number that is not finite, focal lengths that are not positive, an
  // image size outside 1..65536 on either side or more than 2^28 pixels.
  static Result<CameraModel> FromString(const std::string& text, const std::string& file);
  static Result<CameraModel> FromFile(const std::filesystem::path& path);
  // The same lens model and picture with other intrinsics, as many and finite: a step of a
  // derivative. Nothing is checked.
  CameraModel WithIntrinsics(std::vector<double> intrinsics) const;
  // The same lens where a pixel is a block of so many pixels a side of this one's, pixels beyond
  // the last whole block cut off. block is at least 1 and at most the picture's smaller side.
  CameraModel InBlocks(int block) const;
  static CameraModel Pinhole(int width, int height, double fx, double fy, double cx, double cy);

  int width() const { return width_; }
  int height() const { return height_; }
  // mrcal's name with its configuration, for example "LENSMODEL_OPENCV8".
  const std::string& lens_model() const { return lens_model_; }
  const std::vector<double>& intrinsics() const { return intrinsics_; }

  // Unit directions in C of image points, exact to 1e-7 pixels and better; a point that the lens
  // model does not reach gives NaN: no direction projects there, or only the mirrored branch does.
  std::vector<Eigen::Vector3d> Unproject(const std::vector<Eigen::Vector2d>& points) const;
  // Image points of directions or positions in C (z forward). A failed one gives NaN: the origin, a
  // number that is not finite, z <= 0 for a lens model that cannot see behind itself.
  std::vector<Eigen::Vector2d> Project(const std::vector<Eigen::Vector3d>& p_C) const;

  // The text of a .cameramodel file; numbers have as many digits as reading the same bits back
  // needs.
  std::string ToString() const;

 private:
  CameraModel() = default;
  int width_ = 0;
  int height_ = 0;
  std::string lens_model_;
  std::vector<double> intrinsics_;
};

// The unit rays of all pixels of a camera, with one pixel of margin all round, from which rays
// anywhere within a pixel and ray differentials follow by quadratic interpolation. Its error is
// about 0.3 / f^3 radians for a focal length of f pixels: 3e-7 at 100, 2e-9 at 500. Built once per
// camera, in parallel.
class RayGrid {
 public:
  explicit RayGrid(const CameraModel& camera);

  int width() const { return width_; }
  int height() const { return height_; }
  // Unit direction in C at image point (column + du, row + dv), |du|, |dv| <= 1; NaN where the lens
  // does not reach.
  Eigen::Vector3d Ray(int column, int row, double du = 0.0, double dv = 0.0) const;
  // Derivatives of the unit ray by image coordinates at the pixel's centre, columns d/du and d/dv.
  Eigen::Matrix<double, 3, 2> Differential(int column, int row) const;

 private:
  const Eigen::Vector3d& At(int column, int row) const {
    return rays_[static_cast<std::size_t>(row + 1) * (width_ + 2) + (column + 1)];
  }
  int width_;
  int height_;
  std::vector<Eigen::Vector3d> rays_;
};

}  // namespace turnlight::calib
