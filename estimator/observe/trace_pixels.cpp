#include "estimator/observe/trace_pixels.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "base/parallel.h"
#include "estimator/observe/broken_pixels.h"

namespace turnlight::estimator::observe {
namespace {

using Eigen::Vector3d;

// n.v below which a pixel is grazing: at the limb of a curved surface the geometry changes by more
// than its own size across a pixel; a plane's footprint stays linear for longer.
constexpr double kGrazingCurved = 0.25;
constexpr double kGrazingPlane = 0.1;
constexpr int kSilhouetteMargin = 2;  // pixels

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

struct Hit {
  Vector3d mirrored_T;
  target::SurfacePoint point;
  Vector3d to_viewer_T;
};

class FrameTracer {
 public:
  FrameTracer(const calib::RigPoses& poses, const target::Geometry& geometry,
              const calib::RayGrid& rays)
      : X_WT_(poses.X_WT),
        geometry_(geometry),
        rays_(rays),
        X_TC_(poses.X_WT.Inverse() * poses.X_WC) {}

  // About the point (column + du, row + dv), |du|, |dv| <= 0.5.
  std::optional<PixelGeometry> Trace(int column, int row, double du, double dv) const {
    const auto center = TraceRay(column, row, du, dv);
    if (!center) return std::nullopt;
    PixelGeometry pixel;
    const Eigen::Matrix3d& R_WT = X_WT_.rotation;
    pixel.position = X_WT_ * center->point.position;
    pixel.normal = R_WT * center->point.normal;
    pixel.face_normal = R_WT * center->point.geometric_normal;
    pixel.mirrored = R_WT * center->mirrored_T;
    pixel.cosine = std::min(center->point.normal.dot(center->to_viewer_T),
                            center->point.geometric_normal.dot(center->to_viewer_T));
    const auto left = TraceRay(column, row, du - 0.5, dv);
    const auto right = TraceRay(column, row, du + 0.5, dv);
    const auto up = TraceRay(column, row, du, dv - 0.5);
    const auto down = TraceRay(column, row, du, dv + 0.5);
    if (!left || !right || !up || !down) return pixel;
    pixel.normal = R_WT * MeanOver(center->point.normal, left->point.normal, right->point.normal,
                                   up->point.normal, down->point.normal);
    const Vector3d& n = center->point.geometric_normal;
    const Vector3d bend =
        MeanOver(center->point.position, left->point.position, right->point.position,
                 up->point.position, down->point.position) -
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

 private:
  std::optional<Hit> TraceRay(int column, int row, double du, double dv) const {
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
  bool Smooth(const Hit& a, const Hit& b, const Hit& c) const {
    const double bend = (a.point.position + c.point.position - 2.0 * b.point.position).norm();
    const double step = (a.point.position - c.point.position).norm();
    const double turn_bend = (a.mirrored_T + c.mirrored_T - 2.0 * b.mirrored_T).norm();
    const double turn = (a.mirrored_T - c.mirrored_T).norm();
    return bend <= 0.3 * step + 1e-9 * geometry_.radius() && turn_bend <= 0.3 * turn + 0.002;
  }

  const calib::Pose& X_WT_;
  const target::Geometry& geometry_;
  const calib::RayGrid& rays_;
  calib::Pose X_TC_;
};

cv::Mat1b Eroded(const cv::Mat1b& mask, int margin) {
  cv::Mat1b result;
  cv::erode(mask, result, cv::Mat1b::ones(2 * margin + 1, 2 * margin + 1), {-1, -1}, 1,
            cv::BORDER_CONSTANT, cv::Scalar(255));
  return result;
}

}  // namespace

std::optional<PixelGeometry> TracePixel(const calib::RigPoses& poses,
                                        const target::Geometry& geometry,
                                        const calib::RayGrid& rays, const Eigen::Vector2d& point) {
  const Eigen::Vector2d pixel = point.array().round();
  if (!(pixel.x() >= 0.0 && pixel.x() < rays.width() && pixel.y() >= 0.0 &&
        pixel.y() < rays.height()))
    return std::nullopt;
  const Eigen::Vector2d within = point - pixel;
  return FrameTracer(poses, geometry, rays)
      .Trace(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()), within.x(), within.y());
}

FramePixels TraceKeyframe(const model::Keyframe& keyframe, const target::Geometry& geometry,
                          const calib::RayGrid& rays) {
  const int width = rays.width(), height = rays.height();
  const calib::RigPoses poses{keyframe.X_WC, keyframe.X_WT};
  const FrameTracer tracer(poses, geometry, rays);
  std::vector<std::optional<PixelGeometry>> traced(static_cast<std::size_t>(width) * height);
  cv::Mat1b target(height, width, std::uint8_t{0});
  ParallelFor(static_cast<std::size_t>(height), [&](std::size_t r) {
    const int row = static_cast<int>(r);
    for (int column = 0; column < width; ++column) {
      if (keyframe.mask(row, column) == 0) continue;
      auto& pixel = traced[r * width + column];
      pixel = tracer.Trace(column, row, 0.0, 0.0);
      if (pixel) target(row, column) = 255;
    }
  });
  const cv::Mat1b inside = Eroded(target, kSilhouetteMargin);
  const cv::Mat1b broken = FindBrokenPixels(keyframe.image.radiance, target);
  // Charge and interpolation spill over from what is far too bright; noise does not.
  cv::Mat1b saturated = keyframe.image.saturated | ((broken & kImplausible) != 0);
  cv::dilate(saturated, saturated, cv::Mat1b::ones(3, 3));
  const double grazing =
      std::holds_alternative<calib::PlaneShape>(geometry.shape()) ? kGrazingPlane : kGrazingCurved;
  FramePixels out;
  out.flags.create(height, width);
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const std::size_t index = static_cast<std::size_t>(row) * width + column;
      const auto& pixel = traced[index];
      std::uint8_t flag = 0;
      if (!pixel) flag |= kOffTarget;
      if (saturated(row, column) != 0) flag |= kSaturated;
      if ((broken(row, column) & kOutlier) != 0) flag |= kUnlikeOthers;
      if ((broken(row, column) & kFloored) != 0) flag |= kLostInNoise;
      if (pixel && (inside(row, column) == 0 || !pixel->smooth)) flag |= kSilhouette;
      if (pixel && pixel->cosine < grazing) flag |= kGrazing;
      out.flags(row, column) = flag;
      if (flag != 0) continue;
      out.geometry.push_back(*pixel);
      out.pixel.push_back(static_cast<std::uint32_t>(index));
    }
  return out;
}

}  // namespace turnlight::estimator::observe
