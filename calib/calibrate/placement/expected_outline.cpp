#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "calib/calibrate/placement/contour.h"
#include "calib/calibrate/placement/placement.h"
#include "calib/calibrate/placement/residuals.h"

namespace turnlight::calib::calibrate::placement {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kCirclePoints = 720;

// Where rays from the camera touch a sphere.
std::vector<Vector2d> SphereOutline(const calib::CameraModel& camera, const Vector3d& center_C,
                                    double radius) {
  const double distance = center_C.norm();
  const double sine = radius / distance;
  if (!(sine < 1.0)) return {};
  const double cosine = std::sqrt(1.0 - sine * sine);
  const Vector3d axis = center_C / distance;
  const Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
  std::vector<Vector3d> rays;
  for (int i = 0; i <= kCirclePoints; ++i) {
    const double turn = 2.0 * std::numbers::pi * (i % kCirclePoints) / kCirclePoints;
    rays.push_back(cosine * axis + sine * (std::cos(turn) * u + std::sin(turn) * v));
  }
  std::vector<Vector2d> outline = camera.Project(rays);
  std::erase_if(outline, [](const Vector2d& p) { return !p.allFinite(); });
  return outline;
}

// Segments in the order of their angle about their middle.
std::vector<Segment> ContourInOrder(const rig::RigCalibration& calibration,
                                    const calib::TargetShape& shape, const calib::Pose& X_CT) {
  std::vector<Segment> segments = ContourFinder(shape).Find(X_CT, calibration.lens);
  Vector2d middle = Vector2d::Zero();
  for (const Segment& s : segments)
    middle += 0.5 * (s.a + s.b) / static_cast<double>(segments.size());
  const auto angle = [&](const Segment& s) {
    const Vector2d from = 0.5 * (s.a + s.b) - middle;
    return std::atan2(from.y(), from.x());
  };
  std::stable_sort(segments.begin(), segments.end(),
                   [&](const Segment& s, const Segment& t) { return angle(s) < angle(t); });
  // Each from its end nearer to the one before.
  for (Segment& s : segments) {
    const Vector2d along = s.b - s.a, from = 0.5 * (s.a + s.b) - middle;
    if (from.x() * along.y() - from.y() * along.x() < 0.0) {
      std::swap(s.a, s.b);
      std::swap(s.a_T, s.b_T);
    }
  }
  return segments;
}

}  // namespace

std::vector<std::vector<Vector2d>> ExpectedOutline(const rig::RigCalibration& calibration,
                                                   const calib::TargetShape& shape,
                                                   const calib::Pose& X_AT, double angle_deg) {
  const calib::Pose X_CT = PoseOfTableInCamera(calibration.geometry, angle_deg) * X_AT;
  if (const auto* sphere = std::get_if<calib::SphereShape>(&shape))
    return {SphereOutline(calibration.lens, X_CT.translation, sphere->radius)};
  std::vector<std::vector<Vector2d>> lines;
  for (const Segment& segment : ContourFinder(shape).Find(X_CT, calibration.lens))
    lines.push_back({segment.a, segment.b});
  return lines;
}

std::vector<OutlinePoint> SampleOutline(const rig::RigCalibration& calibration,
                                        const calib::TargetShape& shape, const calib::Pose& X_AT,
                                        double angle_deg, double spacing) {
  const calib::Pose X_CT = PoseOfTableInCamera(calibration.geometry, angle_deg) * X_AT;
  std::vector<OutlinePoint> points;
  double due = 0.5 * spacing;  // along the segment
  const auto walk = [&](const Vector2d& a, const Vector2d& b, const Vector2d& normal) {
    const double length = (b - a).norm();
    for (; due < length; due += spacing) points.push_back({a + due / length * (b - a), normal});
    due -= length;
  };
  if (const auto* sphere = std::get_if<calib::SphereShape>(&shape)) {
    const auto outline = SphereOutline(calibration.lens, X_CT.translation, sphere->radius);
    Vector2d middle = Vector2d::Zero();
    for (const Vector2d& p : outline) middle += p / static_cast<double>(outline.size());
    for (std::size_t i = 0; i + 1 < outline.size(); ++i) {
      const Vector2d along = outline[i + 1] - outline[i];
      Vector2d normal = Vector2d(along.y(), -along.x()).normalized();
      if (normal.dot(outline[i] - middle) < 0.0) normal = -normal;
      walk(outline[i], outline[i + 1], normal);
    }
    return points;
  }
  for (const Segment& s : ContourInOrder(calibration, shape, X_CT)) walk(s.a, s.b, s.normal);
  return points;
}

}  // namespace turnlight::calib::calibrate::placement
