#include "estimator/pictures/sphere.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "base/parallel.h"

namespace turnlight::estimator::pictures {
namespace {

using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Where a light is, seen from a point in W.
struct LightRay {
  Vector3d direction;  // unit
  double distance;     // infinite for a distant light
  double irradiance;   // on a surface facing it, before colour
};

LightRay RayTo(const model::Light& light, const Vector3d& p_W) {
  const Vector3d to_light = light.Toward(p_W);
  const double length = to_light.norm();
  return {to_light / length,
          light.inverse_distance > 0.0 ? length / light.inverse_distance : kInfinity,
          light.intensity / (length * length)};
}

// Distance along the unit direction at which a ball is entered, infinite if it is not. A start
// inside or on the ball that leads further in gives 0.
double EnterBall(const Vector3d& center, double radius, const Vector3d& origin,
                 const Vector3d& direction) {
  const Vector3d to_center = center - origin;
  const double along = to_center.dot(direction);
  if (along <= 0.0) return kInfinity;
  const double half_chord_squared = radius * radius - (to_center - along * direction).squaredNorm();
  if (half_chord_squared <= 0.0) return kInfinity;
  return std::max(0.0, along - std::sqrt(half_chord_squared));
}

class Tracer {
 public:
  Tracer(const PictureView& view, const VirtualSphere& sphere)
      : view_(view), sphere_(sphere), X_TW_(view.X_WT.Inverse()) {}

  // What one ray meets first, and what that does to the picture.
  enum class Meets { kSphere, kTarget, kBackground };
  struct Sample {
    Meets meets = Meets::kBackground;
    Vector3d value = Vector3d::Ones();  // the sphere's radiance, or the scale of the photograph
    bool untouched = true;              // neither sphere nor its shadow
  };

  Sample Trace(const Vector3d& ray_C) const {
    const Vector3d origin = view_.X_WC.translation;
    const Vector3d direction = view_.X_WC.rotation * ray_C;
    const double to_sphere = EnterBall(sphere_.center, sphere_.radius, origin, direction);
    const auto target = view_.geometry.Intersect(X_TW_ * origin, X_TW_.rotation * direction);
    if (to_sphere < (target ? target->distance : kInfinity))
      return {Meets::kSphere, SphereRadiance(origin + to_sphere * direction, direction), false};
    if (target) return ShadeTarget(*target, direction);
    return ShadeGround(origin, direction);
  }

 private:
  bool SphereHides(const Vector3d& p_W, const LightRay& light) const {
    return EnterBall(sphere_.center, sphere_.radius, p_W, light.direction) < light.distance;
  }

  // Whether the target lies between a point that is not on it and a light.
  bool TargetHides(const Vector3d& p_W, const Vector3d& normal_W, const LightRay& light) const {
    const Vector3d origin = X_TW_ * p_W;
    const Vector3d direction = X_TW_.rotation * light.direction;
    const calib::TargetShape& shape = view_.geometry.shape();
    if (const auto* ball = std::get_if<calib::SphereShape>(&shape))
      return EnterBall(Vector3d::Zero(), ball->radius, origin, direction) < light.distance;
    if (const auto* board = std::get_if<calib::PlaneShape>(&shape)) {
      const double t = -origin.z() / direction.z();
      if (!(t > 0.0 && t < light.distance)) return false;
      const Vector3d p = origin + t * direction;
      return std::abs(p.x()) <= 0.5 * board->width && std::abs(p.y()) <= 0.5 * board->height;
    }
    return view_.geometry.Occluded(origin, X_TW_.rotation * normal_W, direction, light.distance);
  }

  Vector3d SphereRadiance(const Vector3d& p_W, const Vector3d& direction) const {
    const Vector3d normal = (p_W - sphere_.center).normalized();
    model::LightMask visible = model::kAllLights;
    for (std::size_t l = 0; l < view_.scene.lights.size(); ++l)
      if (TargetHides(p_W, normal, RayTo(view_.scene.lights[l], p_W)))
        visible &= ~(model::LightMask{1} << l);
    return model::Shade(view_.scene, p_W, normal, -direction, visible);
  }

  Sample ShadeTarget(const target::SurfacePoint& point, const Vector3d& direction) const {
    const Vector3d p_W = view_.X_WT * point.position;
    const Vector3d normal = view_.X_WT.rotation * point.normal;
    const bool shadows_itself = view_.geometry.CanShadowItself();
    model::LightMask before = model::kAllLights, after = model::kAllLights;
    for (std::size_t l = 0; l < view_.scene.lights.size(); ++l) {
      const LightRay light = RayTo(view_.scene.lights[l], p_W);
      if (normal.dot(light.direction) <= 0.0) continue;
      const model::LightMask bit = model::LightMask{1} << l;
      const Vector3d direction_T = X_TW_.rotation * light.direction;
      if (shadows_itself && view_.geometry.Occluded(point.position, point.geometric_normal,
                                                    direction_T, light.distance)) {
        before &= ~bit;
        after &= ~bit;
      } else if (SphereHides(p_W, light)) {
        after &= ~bit;
      }
    }
    if (after == before) return {Meets::kTarget};
    return {Meets::kTarget,
            Ratio(model::Shade(view_.scene, p_W, normal, -direction, after),
                  model::Shade(view_.scene, p_W, normal, -direction, before)),
            false};
  }

  Sample ShadeGround(const Vector3d& origin, const Vector3d& direction) const {
    if (!sphere_.ground) return {};
    const Vector3d& normal = sphere_.ground->normal;
    const double t = (sphere_.ground->offset - normal.dot(origin)) / normal.dot(direction);
    if (!(normal.dot(direction) < 0.0 && t > 0.0)) return {};
    const Vector3d p_W = origin + t * direction;
    const model::Reflectance& reflectance = view_.scene.reflectance;
    Vector3d with_sphere = model::AmbientTerm(reflectance, normal) * reflectance.ambient_colour;
    Vector3d without = with_sphere;
    bool untouched = true;
    for (const model::Light& light : view_.scene.lights) {
      const LightRay ray = RayTo(light, p_W);
      const double cosine = normal.dot(ray.direction);
      if (cosine <= 0.0 || TargetHides(p_W, normal, ray)) continue;
      const Vector3d share = reflectance.diffuse * ray.irradiance * cosine * light.color;
      without += share;
      if (SphereHides(p_W, ray)) {
        untouched = false;
      } else {
        with_sphere += share;
      }
    }
    return {Meets::kBackground, Ratio(with_sphere, without), untouched};
  }

  // 1 where there is nothing to darken.
  static Vector3d Ratio(const Vector3d& after, const Vector3d& before) {
    Vector3d ratio = Vector3d::Ones();
    for (int c = 0; c < 3; ++c)
      if (before[c] > 0.0) ratio[c] = std::clamp(after[c] / before[c], 0.0, 1.0);
    return ratio;
  }

  const PictureView& view_;
  const VirtualSphere& sphere_;
  calib::Pose X_TW_;
};

// Pixels that the sphere or its shadow touch, by looking at their corners; one pixel more all round
// for what slips between corners.
cv::Mat1b TouchedPixels(const Tracer& tracer, const calib::RayGrid& rays) {
  const int width = rays.width(), height = rays.height();
  cv::Mat1b corners(height + 1, width + 1, uchar{0});
  ParallelFor(static_cast<std::size_t>(height) + 1, [&](std::size_t index) {
    const int row = static_cast<int>(index);
    const int pixel_row = std::min(row, height - 1);
    for (int column = 0; column <= width; ++column) {
      const int pixel_column = std::min(column, width - 1);
      const Vector3d ray =
          rays.Ray(pixel_column, pixel_row, column - pixel_column - 0.5, row - pixel_row - 0.5);
      if (ray.allFinite() && !tracer.Trace(ray).untouched) corners(row, column) = 255;
    }
  });
  cv::Mat1b wide;
  cv::dilate(corners, wide, cv::Mat1b(4, 4, uchar{1}), {2, 2});
  return wide(cv::Rect(0, 0, width, height));
}

// The mean over a pixel of what its sub-samples meet, given the two parts of the photograph there.
cv::Vec3f ComposePixel(const Tracer& tracer, const PictureView& view, int column, int row,
                       const cv::Vec3d& target, const cv::Vec3d& background) {
  const int samples = view.samples_per_side;
  cv::Vec3d sum(0, 0, 0);
  for (int j = 0; j < samples; ++j) {
    for (int i = 0; i < samples; ++i) {
      const Vector3d ray =
          view.rays.Ray(column, row, (i + 0.5) / samples - 0.5, (j + 0.5) / samples - 0.5);
      const Tracer::Sample sample = ray.allFinite() ? tracer.Trace(ray) : Tracer::Sample{};
      const cv::Vec3d value(sample.value[0], sample.value[1], sample.value[2]);
      if (sample.meets == Tracer::Meets::kSphere)
        sum += value;
      else
        sum += value.mul(sample.meets == Tracer::Meets::kTarget ? target : background);
    }
  }
  return cv::Vec3f(sum * (1.0 / (samples * samples)));
}

}  // namespace

cv::Mat3f InsertSphere(const cv::Mat3f& photograph, const Matte& matte, const PictureView& view,
                       const VirtualSphere& sphere) {
  const Tracer tracer(view, sphere);
  const cv::Mat1b touched = TouchedPixels(tracer, view.rays);
  cv::Mat3f result = photograph.clone();
  ParallelFor(static_cast<std::size_t>(result.rows), [&](std::size_t index) {
    const int row = static_cast<int>(index);
    for (int column = 0; column < result.cols; ++column)
      if (touched(row, column) != 0)
        result(row, column) = ComposePixel(tracer, view, column, row, matte.target(row, column),
                                           matte.background(row, column));
  });
  return result;
}

}  // namespace turnlight::estimator::pictures
