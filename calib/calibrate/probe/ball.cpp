#include "calib/calibrate/probe/ball.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace turnlight::calib::calibrate::probe {

using Eigen::Vector2d;
using Eigen::Vector3d;

std::optional<Mirrored> MirrorOnBall(const Ball& ball, const Vector3d& origin,
                                     const Vector3d& ray) {
  const Vector3d to_center = ball.center - origin;
  const double along = to_center.dot(ray);
  const double half_chord_squared =
      ball.radius * ball.radius - (to_center - along * ray).squaredNorm();
  if (!(along > 0.0) || !(half_chord_squared > 0.0)) return std::nullopt;
  const double distance = along - std::sqrt(half_chord_squared);
  if (!(distance > 0.0)) return std::nullopt;
  Mirrored mirrored;
  mirrored.point = origin + distance * ray;
  const Vector3d normal = (mirrored.point - ball.center) / ball.radius;
  mirrored.cosine = -normal.dot(ray);
  mirrored.direction = (ray + 2.0 * mirrored.cosine * normal).normalized();
  return mirrored;
}

std::optional<Mirrored> MirrorAt(const BallView& view, const Vector2d& pixel) {
  const int column =
      std::clamp(static_cast<int>(std::lround(pixel.x())), 0, view.rays->width() - 1);
  const int row = std::clamp(static_cast<int>(std::lround(pixel.y())), 0, view.rays->height() - 1);
  const Vector2d off(pixel.x() - column, pixel.y() - row);
  if (!(off.cwiseAbs().maxCoeff() <= 1.0)) return std::nullopt;
  const Vector3d ray = view.X_WC.rotation * view.rays->Ray(column, row, off.x(), off.y());
  return MirrorOnBall(view.ball, view.X_WC.translation, ray);
}

std::optional<Eigen::Matrix<double, 3, 2>> MirrorDifferential(const BallView& view,
                                                              const Vector2d& pixel) {
  constexpr double kStep = 0.25;  // pixels: the mirrored direction is smooth within it
  Eigen::Matrix<double, 3, 2> differential;
  for (int axis = 0; axis < 2; ++axis) {
    const Vector2d step = kStep * Vector2d::Unit(axis);
    const auto after = MirrorAt(view, pixel + step);
    const auto before = MirrorAt(view, pixel - step);
    if (!after || !before) return std::nullopt;
    differential.col(axis) = (after->direction - before->direction) / (2.0 * kStep);
  }
  return differential;
}

std::optional<Vector3d> MirrorPoint(const Ball& ball, const Vector3d& eye, const Vector3d& u,
                                    double rho) {
  const Vector3d to_eye = (eye - ball.center).normalized();
  const Vector3d to_light = (u - rho * ball.center).normalized();
  const Vector3d across = to_light - to_light.dot(to_eye) * to_eye;
  if (across.norm() < 1e-12) {
    if (to_light.dot(to_eye) < 0.0) return std::nullopt;
    return ball.center + ball.radius * to_eye;
  }
  const Vector3d side = across.normalized();
  double low = 0.0, high = std::atan2(across.norm(), to_light.dot(to_eye));
  Vector3d point;
  double light_cosine = 0.0;
  for (int i = 0; i < 60; ++i) {
    const double angle = 0.5 * (low + high);
    const Vector3d normal = std::cos(angle) * to_eye + std::sin(angle) * side;
    point = ball.center + ball.radius * normal;
    light_cosine = normal.dot((u - rho * point).normalized());
    (normal.dot((eye - point).normalized()) > light_cosine ? low : high) = angle;
  }
  if (light_cosine <= 0.0) return std::nullopt;
  return point;
}

std::optional<Vector2d> PixelOfLight(const BallView& view, const Vector3d& u, double rho) {
  const auto point = MirrorPoint(view.ball, view.X_WC.translation, u, rho);
  if (!point) return std::nullopt;
  const Vector2d pixel = view.camera->Project({view.X_WC.Inverse() * *point}).front();
  const bool inside = pixel.x() >= -0.5 && pixel.y() >= -0.5 &&
                      pixel.x() <= view.camera->width() - 0.5 &&
                      pixel.y() <= view.camera->height() - 0.5;
  if (!inside) return std::nullopt;
  return pixel;
}

double RadiusInPixels(const BallView& view) {
  const CameraModel& camera = *view.camera;
  const Vector3d center_C = view.X_WC.Inverse() * view.ball.center;
  const double distance = center_C.norm();
  if (!(distance > view.ball.radius) || !(center_C.z() > 0.0)) return 0.0;
  const Vector2d seen = camera.Project({center_C}).front();
  if (!seen.allFinite()) return 0.0;
  const int column = static_cast<int>(std::clamp(seen.x(), 0.0, camera.width() - 1.0));
  const int row = static_cast<int>(std::clamp(seen.y(), 0.0, camera.height() - 1.0));
  const double per_pixel = view.rays->Differential(column, row).norm() / std::numbers::sqrt2;
  return std::asin(view.ball.radius / distance) / per_pixel;
}

Eigen::Matrix<double, 3, 2> Across(const Vector3d& u) {
  Eigen::Matrix<double, 3, 2> across;
  across.col(0) = u.unitOrthogonal();
  across.col(1) = u.cross(across.col(0));
  return across;
}

}  // namespace turnlight::calib::calibrate::probe
