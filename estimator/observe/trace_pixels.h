// What a pixel sees of the target.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "calib/camera_model.h"
#include "calib/rig_geometry.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::observe {

// The part of a pixel's width over which it averages. Of the mean over 5 x 5 points, as renderers
// take it (ours by default too), the variance is 24/25 of a box's; a camera's is known no better.
inline constexpr double kAperture = 0.97979589711327124;

// One pixel's geometry in W: means over its footprint, and their change across it.
struct PixelGeometry {
  Eigen::Vector3d position, normal, face_normal, mirrored;
  Eigen::Vector3d dw_du = Eigen::Vector3d::Zero(), dw_dv = Eigen::Vector3d::Zero();
  Eigen::Vector3d dx_du = Eigen::Vector3d::Zero(), dx_dv = Eigen::Vector3d::Zero();
  double cosine = 0.0;  // n.v
  bool smooth = false;  // the footprint lies on one smooth piece of surface
};

// Traces pixels of one keyframe. Geometry and rays must outlive it. Safe to use from several
// threads.
class PixelTracer {
 public:
  PixelTracer(const calib::RigPoses& poses, const target::Geometry& geometry,
              const calib::RayGrid& rays);

  // About the point (column + du, row + dv), |du|, |dv| <= 0.5. None if that point meets nothing.
  std::optional<PixelGeometry> Trace(int column, int row, double du = 0.0, double dv = 0.0) const;
  // n.v at the pixel's middle, as Trace gives it; none if that meets nothing.
  std::optional<double> Cosine(int column, int row) const;

 private:
  struct Hit;
  std::optional<Hit> TraceRay(int column, int row, double du, double dv) const;
  bool Smooth(const Hit& a, const Hit& b, const Hit& c) const;

  calib::Pose X_WT_;
  const target::Geometry& geometry_;
  const calib::RayGrid& rays_;
  calib::Pose X_TC_;
};

// One pixel's width about an image point; not smooth if it meets no one piece of surface all round.
// None if its middle meets nothing, or lies outside the picture.
std::optional<PixelGeometry> TracePixel(const calib::RigPoses& poses,
                                        const target::Geometry& geometry,
                                        const calib::RayGrid& rays, const Eigen::Vector2d& point);

}  // namespace turnlight::estimator::observe
