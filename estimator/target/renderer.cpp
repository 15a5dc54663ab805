#include "estimator/target/renderer.h"

#include <limits>

#include "base/parallel.h"

namespace turnlight::estimator::target {
namespace {

using Eigen::Vector3d;

// What one sub-sample of a pixel sees.
struct Sample {
  Vector3d radiance = Vector3d::Zero();
  bool hit = false;
};

// One keyframe's view of the target, tracing in T and shading in W.
struct View {
  const model::Scene& scene;
  const Geometry& geometry;
  const calib::Pose& X_WT;
  calib::Pose X_TC;
  bool cast_shadows;

  model::LightMask VisibleLights(const SurfacePoint& point, const Vector3d& p_W) const {
    model::LightMask visible = model::kAllLights;
    for (std::size_t l = 0; l < scene.lights.size(); ++l) {
      const model::Light& light = scene.lights[l];
      const Vector3d to_light = light.Toward(p_W);
      const double length = to_light.norm();
      const double distance = light.inverse_distance > 0.0
                                  ? length / light.inverse_distance
                                  : std::numeric_limits<double>::infinity();
      const Vector3d direction_T = X_WT.rotation.transpose() * (to_light / length);
      if (geometry.Occluded(point.position, point.geometric_normal, direction_T, distance))
        visible &= ~(model::LightMask{1} << l);
    }
    return visible;
  }

  Sample Trace(const Vector3d& ray_C) const {
    const Vector3d direction_T = X_TC.rotation * ray_C;
    const auto point = geometry.Intersect(X_TC.translation, direction_T);
    if (!point) return {};
    const Vector3d p_W = X_WT * point->position;
    const model::LightMask visible =
        cast_shadows && geometry.CanShadowItself() ? VisibleLights(*point, p_W) : model::kAllLights;
    return {model::Shade(scene, p_W, X_WT.rotation * point->normal,
                         -(X_WT.rotation * direction_T.normalized()), visible),
            true};
  }

  // Whether any of the pixel's footprint can meet the ball that holds the target.
  bool NearTarget(const Vector3d& ray_C, const Eigen::Matrix<double, 3, 2>& differential) const {
    const Vector3d to_center = X_TC.Inverse() * geometry.center();
    const double along = to_center.dot(ray_C);
    const double off = (to_center - along * ray_C).norm();
    const double footprint = differential.norm() * to_center.norm();
    const bool inside = to_center.norm() <= geometry.radius();
    return inside || (along > 0.0 && !(off > geometry.radius() + footprint));
  }
};

void RenderPixel(const View& view, const calib::RayGrid& rays, int column, int row, int samples,
                 Rendering& out) {
  const Vector3d center = rays.Ray(column, row);
  if (!center.allFinite() || !view.NearTarget(center, rays.Differential(column, row))) return;
  Vector3d sum = Vector3d::Zero();
  int hits = 0;
  for (int j = 0; j < samples; ++j) {
    for (int i = 0; i < samples; ++i) {
      const Vector3d ray =
          rays.Ray(column, row, (i + 0.5) / samples - 0.5, (j + 0.5) / samples - 0.5);
      if (!ray.allFinite()) continue;
      const Sample sample = view.Trace(ray);
      sum += sample.radiance;
      hits += sample.hit ? 1 : 0;
    }
  }
  const double count = static_cast<double>(samples) * samples;
  const Eigen::Vector3f mean = (sum / count).cast<float>();
  out.radiance(row, column) = cv::Vec3f(mean[0], mean[1], mean[2]);
  out.coverage(row, column) = static_cast<float>(hits / count);
}

}  // namespace

Rendering Render(const model::Scene& scene, const Geometry& geometry, const calib::RayGrid& rays,
                 const calib::Pose& X_WC, const calib::Pose& X_WT, const RenderOptions& options) {
  Rendering out{cv::Mat3f(rays.height(), rays.width(), cv::Vec3f(0, 0, 0)),
                cv::Mat1f(rays.height(), rays.width(), 0.0f)};
  const View view{scene, geometry, X_WT, X_WT.Inverse() * X_WC, options.cast_shadows};
  ParallelFor(static_cast<std::size_t>(rays.height()), [&](std::size_t row) {
    for (int column = 0; column < rays.width(); ++column)
      RenderPixel(view, rays, column, static_cast<int>(row), options.samples_per_side, out);
  });
  return out;
}

}  // namespace turnlight::estimator::target
