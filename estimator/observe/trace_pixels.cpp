#include "estimator/observe/trace_pixels.h"

#include <algorithm>
#include <cmath>

namespace turnlight::estimator::observe {
namespace {

using Eigen::Vector3d;

Vector3d Mirror(const Vector3d& to_viewer, const Vector3d& normal) {
  return (2.0 * normal.dot(to_viewer) * normal - to_viewer).normalized();
}

// The mean over a pixel of what has these values at its centre and in the middle of its edges,
// exact for second-order surfaces: f + a^2 (f_uu + f_vv) / 24. At the limb it is 1e-4 off the
// centre.
Vector3d MeanOver(const Vector3d& center, const Vector3d& left, const Vector3d& right,
                  const Vector3d& up, const Vector3d& down) {
  return center + (left + right + up + down - 4.0 * center) * (kAperture * kAperture / 6.0);
}

}  // namespace

struct PixelTracer::Hit {
  Vector3d mirrored_T;
  target::SurfacePoint point;
  Vector3d to_viewer_T;

  double Cosine() const {
    return std::min(point.normal.dot(to_viewer_T), point.geometric_normal.dot(to_viewer_T));
  }
};

PixelTracer::PixelTracer(const calib::RigPoses& poses, const target::Geometry& geometry,
                         const calib::RayGrid& rays)
    : X_WT_(poses.X_WT),
      geometry_(geometry),
      rays_(rays),
      X_TC_(poses.X_WT.Inverse() * poses.X_WC) {}

std::optional<PixelGeometry> PixelTracer::Trace(int column, int row, double du, double dv) const {
  const auto center = TraceRay(column, row, du, dv);
  if (!center) return std::nullopt;
  PixelGeometry pixel;
  const Eigen::Matrix3d& R_WT = X_WT_.rotation;
  pixel.position = X_WT_ * center->point.position;
  pixel.normal = R_WT * center->point.normal;
  pixel.face_normal = R_WT * center->point.geometric_normal;
  pixel.mirrored = R_WT * center->mirrored_T;
  pixel.cosine = center->Cosine();
  const auto left = TraceRay(column, row, du - 0.5, dv);
  const auto right = TraceRay(column, row, du + 0.5, dv);
  const auto up = TraceRay(column, row, du, dv - 0.5);
  const auto down = TraceRay(column, row, du, dv + 0.5);
  if (!left || !right || !up || !down) return pixel;
  pixel.normal = R_WT * MeanOver(center->point.normal, left->point.normal, right->point.normal,
                                 up->point.normal, down->point.normal);
  const Vector3d& n = center->point.geometric_normal;
  const Vector3d bend = MeanOver(center->point.position, left->point.position,
                                 right->point.position, up->point.position, down->point.position) -
                        center->point.position;
  pixel.position = X_WT_ * (center->point.position + bend - n.dot(bend) * n);
  pixel.mirrored = R_WT * MeanOver(center->mirrored_T, left->mirrored_T, right->mirrored_T,
                                   up->mirrored_T, down->mirrored_T)
                              .normalized();
  pixel.dw_du = R_WT * (right->mirrored_T - left->mirrored_T);
  pixel.dw_dv = R_WT * (down->mirrored_T - up->mirrored_T);
  pixel.dx_du = R_WT * (right->point.position - left->point.position);
  pixel.dx_dv = R_WT * (down->point.position - up->point.position);
  pixel.smooth = Smooth(*left, *center, *right) && Smooth(*up, *center, *down);
  return pixel;
}

std::optional<PixelTracer::Hit> PixelTracer::TraceRay(int column, int row, double du,
                                                      double dv) const {
  const Vector3d ray = rays_.Ray(column, row, du, dv);
  if (!ray.allFinite()) return std::nullopt;
  const Vector3d direction = X_TC_.rotation * ray;
  auto point = geometry_.Intersect(X_TC_.translation, direction);
  if (!point) return std::nullopt;
  const Vector3d to_viewer = -direction.normalized();
  return Hit{Mirror(to_viewer, point->normal), *point, to_viewer};
}

// Three points in a row on one smooth piece: the middle one is near the mean of the others, both
// in place (a jump of depth) and in mirrored direction (a crease).
bool PixelTracer::Smooth(const Hit& a, const Hit& b, const Hit& c) const {
  const double bend = (a.point.position + c.point.position - 2.0 * b.point.position).norm();
  const double step = (a.point.position - c.point.position).norm();
  const double turn_bend = (a.mirrored_T + c.mirrored_T - 2.0 * b.mirrored_T).norm();
  const double turn = (a.mirrored_T - c.mirrored_T).norm();
  return bend <= 0.3 * step + 1e-9 * geometry_.radius() && turn_bend <= 0.3 * turn + 0.002;
}

std::optional<double> PixelTracer::Cosine(int column, int row) const {
  const auto center = TraceRay(column, row, 0.0, 0.0);
  return center ? std::optional(center->Cosine()) : std::nullopt;
}

std::optional<PixelGeometry> TracePixel(const calib::RigPoses& poses,
                                        const target::Geometry& geometry,
                                        const calib::RayGrid& rays, const Eigen::Vector2d& point) {
  const Eigen::Vector2d pixel = point.array().round();
  if (!(pixel.x() >= 0.0 && pixel.x() < rays.width() && pixel.y() >= 0.0 &&
        pixel.y() < rays.height()))
    return std::nullopt;
  const Eigen::Vector2d within = point - pixel;
  return PixelTracer(poses, geometry, rays)
      .Trace(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()), within.x(), within.y());
}

}  // namespace turnlight::estimator::observe
