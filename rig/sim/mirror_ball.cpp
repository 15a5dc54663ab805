#include "rig/sim/mirror_ball.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "base/parallel.h"

namespace turnlight::rig::sim {
namespace {

using Eigen::Vector3d;

// A pixel is rendered in parts, which the lens blurs before the pixel adds them up.
constexpr int kParts = 4;           // per side
constexpr int kSamplesAtEdges = 4;  // per side of a part; else one

// Where a lamp is, seen from a point.
struct SeenLamp {
  Vector3d direction;  // unit
  double radius;       // radians
};

SeenLamp See(const BallLamp& lamp, const Vector3d& point) {
  const Vector3d toward = lamp.direction - lamp.inverse_distance * point;
  const double share = toward.norm();  // of the distance from W's origin
  return {toward / share, std::asin(std::clamp(std::sin(lamp.angular_radius) / share, 0.0, 1.0))};
}

double AngleBetween(const Vector3d& a, const Vector3d& b) {
  return 2.0 * std::asin(std::min(1.0, 0.5 * (a - b).norm()));
}

bool InWindow(const FarWindow& window, const Vector3d& direction) {
  const double along = window.direction.dot(direction);
  if (along <= 0.0) return false;
  const Vector3d up = std::abs(window.direction.z()) > 0.9 ? Vector3d::UnitY() : Vector3d::UnitZ();
  const Vector3d across = up.cross(window.direction).normalized();
  return std::abs(std::atan2(direction.dot(across), along)) < window.half_width &&
         std::abs(std::atan2(direction.dot(window.direction.cross(across)), along)) <
             window.half_height;
}

class Room {
 public:
  Room(const MirrorBall& ball, const MirrorRoom& room, const Vector3d& eye)
      : ball_(ball), room_(room), eye_(eye) {}

  double Radiance(const Vector3d& ray) const {
    const auto hit = Hit(ray);
    if (!hit) return room_.background;
    const Vector3d mirrored = ray - 2.0 * hit->normal.dot(ray) * hit->normal;
    double seen = room_.floor + 0.5 * (1.0 + mirrored.z()) * (room_.ceiling - room_.floor);
    for (const FarWindow& window : room_.windows)
      if (InWindow(window, mirrored)) seen = window.radiance;
    double shading = 0.0;
    for (const BallLamp& lamp : room_.lamps) {
      const SeenLamp at = See(lamp, hit->point);
      if (AngleBetween(at.direction, mirrored) < at.radius) seen = lamp.radiance;
      const double sine = std::sin(at.radius);
      shading += std::numbers::pi * sine * sine * lamp.radiance *
                 std::max(0.0, hit->normal.dot(at.direction));
    }
    return ball_.reflectance * seen + ball_.diffuse * shading;
  }

  // Whether an edge of anything may run between the mirrored directions of two rays.
  bool MayShowAnEdge(const Vector3d& middle, const Vector3d& corner) const {
    const auto at = Hit(middle), beside = Hit(corner);
    if (!at || !beside) return at.has_value() != beside.has_value();
    const auto mirror = [](const Vector3d& ray, const Vector3d& normal) -> Vector3d {
      return ray - 2.0 * normal.dot(ray) * normal;
    };
    const Vector3d mirrored = mirror(middle, at->normal);
    const double footprint = 2.0 * AngleBetween(mirrored, mirror(corner, beside->normal));
    for (const FarWindow& window : room_.windows)
      if (AngleBetween(window.direction, mirrored) <
          std::hypot(window.half_width, window.half_height) + footprint)
        return true;
    return std::any_of(room_.lamps.begin(), room_.lamps.end(), [&](const BallLamp& lamp) {
      const SeenLamp seen = See(lamp, at->point);
      return AngleBetween(seen.direction, mirrored) < seen.radius + footprint;
    });
  }

 private:
  struct SurfacePoint {
    Vector3d point, normal;
  };
  std::optional<SurfacePoint> Hit(const Vector3d& ray) const {
    const Vector3d to_center = ball_.center - eye_;
    const double along = to_center.dot(ray);
    const double half_squared =
        ball_.radius * ball_.radius - (to_center - along * ray).squaredNorm();
    if (!(along > 0.0) || !(half_squared > 0.0)) return std::nullopt;
    const Vector3d point = eye_ + (along - std::sqrt(half_squared)) * ray;
    return SurfacePoint{point, (point - ball_.center) / ball_.radius};
  }

  const MirrorBall& ball_;
  const MirrorRoom& room_;
  const Vector3d eye_;
};

}  // namespace

cv::Mat1f RenderMirrorBall(const MirrorBall& ball, const MirrorRoom& room,
                           const calib::RayGrid& rays, const calib::Pose& X_WC, double blur_px) {
  const Room world(ball, room, X_WC.translation);
  cv::Mat1f fine(rays.height() * kParts, rays.width() * kParts);
  ParallelFor(static_cast<std::size_t>(rays.height()), [&](std::size_t index) {
    const int row = static_cast<int>(index);
    for (int column = 0; column < rays.width(); ++column) {
      const auto ray = [&](double du, double dv) -> Vector3d {
        return X_WC.rotation * rays.Ray(column, row, du, dv);
      };
      bool edge = false;
      for (const double du : {-0.5, 0.5})
        for (const double dv : {-0.5, 0.5})
          edge = edge || world.MayShowAnEdge(ray(0.0, 0.0), ray(du, dv));
      const int samples = edge ? kSamplesAtEdges : 1;
      const int across = kParts * samples;
      for (int part = 0; part < kParts * kParts; ++part) {
        const int x = part % kParts, y = part / kParts;
        double sum = 0.0;
        for (int j = 0; j < samples; ++j)
          for (int i = 0; i < samples; ++i)
            sum += world.Radiance(ray((x * samples + i + 0.5) / across - 0.5,
                                      (y * samples + j + 0.5) / across - 0.5));
        fine(row * kParts + y, column * kParts + x) = static_cast<float>(sum / (samples * samples));
      }
    }
  });
  if (blur_px > 0.0)
    cv::GaussianBlur(fine, fine, {}, kParts * blur_px, kParts * blur_px, cv::BORDER_REPLICATE);
  cv::Mat1f picture;
  cv::resize(fine, picture, {rays.width(), rays.height()}, 0.0, 0.0, cv::INTER_AREA);
  return picture;
}

}  // namespace turnlight::rig::sim
