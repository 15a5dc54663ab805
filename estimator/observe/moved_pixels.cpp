#include "estimator/observe/moved_pixels.h"

#include "base/parallel.h"
#include "estimator/observe/observation_access.h"
#include "estimator/observe/trace_pixels.h"

namespace turnlight::estimator::observe {
namespace {

Eigen::Vector2d PointOf(const Observations& pixels, const calib::RayGrid& rays, std::size_t i) {
  const auto width = static_cast<std::uint32_t>(rays.width());
  const std::uint32_t row = pixels.pixel[i] / width;
  return {static_cast<double>(pixels.pixel[i] % width), static_cast<double>(row)};
}

// The points whose rays are those of the sample's pixels with the other lens: as far before a pixel
// as the other lens puts the pixel's own ray behind it, to first order.
std::vector<Eigen::Vector2d> PointsOf(const Observations& pixels, const calib::CameraModel* lens,
                                      const calib::RayGrid& rays) {
  std::vector<Eigen::Vector2d> points(pixels.size(), Eigen::Vector2d::Zero());
  std::vector<Eigen::Vector3d> p_C(pixels.size(), Eigen::Vector3d::UnitZ());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels.pixel[i] == Observations::kNoPixel) continue;
    points[i] = PointOf(pixels, rays, i);
    p_C[i] = rays.Ray(static_cast<int>(points[i].x()), static_cast<int>(points[i].y()));
  }
  if (lens == nullptr) return points;
  const std::vector<Eigen::Vector2d> projected = lens->Project(p_C);
  for (std::size_t i = 0; i < pixels.size(); ++i) points[i] = 2.0 * points[i] - projected[i];
  return points;
}

}  // namespace

Observations Moved(const PixelSample& sample, const std::vector<calib::RigPoses>& poses,
                   const calib::CameraModel* lens, const target::Geometry& geometry,
                   const calib::RayGrid& rays, std::vector<std::uint8_t>& seen) {
  Observations out = sample.pixels;
  for (std::size_t k = 0; k < out.X_TW.size(); ++k) out.X_TW[k] = poses[k].X_WT.Inverse();
  const std::vector<Eigen::Vector2d> points = PointsOf(out, lens, rays);
  seen.assign(out.size(), 0);
  ParallelFor(out.tiles(), [&](std::size_t tile) {
    for (std::size_t i = tile * kTile; i < (tile + 1) * kTile; ++i) {
      if (out.pixel[i] == Observations::kNoPixel) continue;
      const auto pixel = TracePixel(poses[sample.keyframe[i]], geometry, rays, points[i]);
      if (!pixel || !pixel->smooth) continue;
      seen[i] = 1;
      Put((pixel->position - out.reference) / out.radius, i, out.position);
      Put(pixel->normal, i, out.normal);
      Put(pixel->mirrored, i, out.mirrored);
      if (out.caster != nullptr) Put(pixel->face_normal, i, out.face_normal);
    }
  });
  return out;
}

}  // namespace turnlight::estimator::observe
