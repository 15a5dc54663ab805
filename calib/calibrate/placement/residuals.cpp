#include "calib/calibrate/placement/residuals.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "base/angles.h"
#include "base/parallel.h"
#include "calib/calibrate/placement/contour.h"

namespace turnlight::calib::calibrate::placement {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// The normals of a measured and of an expected outline agree within acos of this, 25 degrees: more
// apart, and they are different parts of the outline, or one is rounded off at a corner.
constexpr double kNormalsAgree = 0.906;
// Step of numerical derivatives of projections, as a share of the distance.
constexpr double kDerivativeStep = 1e-6;

// A measured point as the camera model sees it, the same for any pose.
struct Sighting {
  Vector3d ray;                          // unit, in C
  Eigen::Matrix<double, 3, 2> by_pixel;  // its derivative
};

std::vector<Sighting> Sight(const calib::CameraModel& camera, const View& view) {
  std::vector<Vector2d> pixels;
  for (const OutlinePoint& point : view.outline)
    for (const Vector2d& step :
         {Vector2d(0, 0), Vector2d(0.5, 0), Vector2d(-0.5, 0), Vector2d(0, 0.5), Vector2d(0, -0.5)})
      pixels.push_back(point.pixel + step);
  const std::vector<Vector3d> rays = camera.Unproject(pixels);
  std::vector<Sighting> sightings(view.outline.size());
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    sightings[i].ray = rays[5 * i];
    sightings[i].by_pixel.col(0) = rays[5 * i + 1] - rays[5 * i + 2];
    sightings[i].by_pixel.col(1) = rays[5 * i + 3] - rays[5 * i + 4];
  }
  return sightings;
}

Residual SphereResidual(const Sighting& seen, const Vector3d& center_C, double radius) {
  Residual residual;
  const double distance = center_C.norm();
  const Vector3d to_center = center_C / distance;
  const double cosine = seen.ray.dot(to_center);
  const double sine = seen.ray.cross(to_center).norm();
  if (!seen.ray.allFinite() || !(distance > radius) || !(sine > 0.0)) return residual;
  const double ratio = radius / distance;
  const double slope = 1.0 / std::sqrt(1.0 - ratio * ratio);  // of asin
  const Vector3d by_ray = (cosine * seen.ray - to_center) / sine;
  const double radians_per_pixel = (by_ray.transpose() * seen.by_pixel).norm();
  if (!(radians_per_pixel > 0.0)) return residual;
  residual.value = (std::atan2(sine, cosine) - std::asin(ratio)) / radians_per_pixel;
  const Vector3d by_center =
      (cosine * to_center - seen.ray) / (sine * distance) + slope * ratio / distance * to_center;
  residual.by_p_C = by_center.transpose() / radians_per_pixel;
  residual.by_radius = -slope / distance / radians_per_pixel;
  residual.valid = true;
  return residual;
}

// Image points of p_C, and their derivatives by it.
struct Projections {
  std::vector<Vector2d> pixel;
  std::vector<Eigen::Matrix<double, 2, 3>> by_p_C;
};

Projections ProjectWithDerivatives(const calib::CameraModel& camera,
                                   const std::vector<Vector3d>& p_C) {
  std::vector<Vector3d> points;
  for (const Vector3d& p : p_C) {
    points.push_back(p);
    const double step = kDerivativeStep * p.norm();
    for (int i = 0; i < 3; ++i)
      for (const double sign : {1.0, -1.0}) points.push_back(p + sign * step * Vector3d::Unit(i));
  }
  const std::vector<Vector2d> pixels = camera.Project(points);
  Projections out;
  for (std::size_t i = 0; i < p_C.size(); ++i) {
    const std::size_t at = 7 * i;
    const double step = kDerivativeStep * p_C[i].norm();
    Eigen::Matrix<double, 2, 3> derivative;
    for (int k = 0; k < 3; ++k)
      derivative.col(k) = (pixels[at + 1 + 2 * static_cast<std::size_t>(k)] -
                           pixels[at + 2 + 2 * static_cast<std::size_t>(k)]) /
                          (2.0 * step);
    out.pixel.push_back(pixels[at]);
    out.by_p_C.push_back(derivative);
  }
  return out;
}

// Segments by the column of their middle, so that those near a point are found quickly.
struct SortedContour {
  explicit SortedContour(std::vector<Segment> found) : segments(std::move(found)) {
    const auto middle = [](const Segment& s) { return 0.5 * (s.a.x() + s.b.x()); };
    std::stable_sort(segments.begin(), segments.end(),
                     [&](const Segment& s, const Segment& t) { return middle(s) < middle(t); });
    for (const Segment& segment : segments) columns.push_back(middle(segment));
  }

  struct Nearest {
    const Segment* segment = nullptr;
    double share = 0.0;  // of the way from a to b
  };
  Nearest Find(const OutlinePoint& point, double reach) const {
    Nearest nearest;
    double best = reach * reach;
    const double around = reach + 0.5 * kLongestPiece;
    auto at = static_cast<std::size_t>(
        std::lower_bound(columns.begin(), columns.end(), point.pixel.x() - around) -
        columns.begin());
    for (; at < segments.size() && columns[at] <= point.pixel.x() + around; ++at) {
      const Segment& segment = segments[at];
      if (segment.normal.dot(point.normal) < kNormalsAgree) continue;
      const Vector2d along = segment.b - segment.a;
      const double share =
          std::clamp(along.dot(point.pixel - segment.a) / along.squaredNorm(), 0.0, 1.0);
      const double distance = (segment.a + share * along - point.pixel).squaredNorm();
      if (distance < best) {
        best = distance;
        nearest = {&segment, share};
      }
    }
    return nearest;
  }

  std::vector<Segment> segments;
  std::vector<double> columns;
};

std::vector<Residual> ContourResiduals(const ContourFinder& finder,
                                       const calib::CameraModel& camera, const View& view,
                                       const calib::Pose& X_CA, const State& state, double reach) {
  const SortedContour contour(finder.Find(X_CA * state.X_AT, camera));
  std::vector<Residual> residuals(view.outline.size());
  std::vector<Vector3d> p_A(view.outline.size(), Vector3d::UnitZ());
  std::vector<Vector3d> p_C(view.outline.size(), Vector3d::UnitZ());
  std::vector<Vector2d> normals(view.outline.size(), Vector2d::UnitX());
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const auto nearest = contour.Find(view.outline[i], reach);
    if (!nearest.segment) continue;
    const Segment& segment = *nearest.segment;
    residuals[i].valid = true;
    p_A[i] = state.X_AT * (segment.a_T + nearest.share * (segment.b_T - segment.a_T));
    p_C[i] = X_CA * p_A[i];
    normals[i] = segment.normal;
  }
  const Projections projected = ProjectWithDerivatives(camera, p_C);
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (!residuals[i].valid) continue;
    residuals[i].valid = projected.pixel[i].allFinite() && projected.by_p_C[i].allFinite();
    residuals[i].value = normals[i].dot(view.outline[i].pixel - projected.pixel[i]);
    residuals[i].by_p_C = -normals[i].transpose() * projected.by_p_C[i];
    residuals[i].p_A = p_A[i];
  }
  return residuals;
}

// What every residual of an outline's point has, and the edge offset.
void Complete(const View& view, std::size_t index, const State& state,
              std::vector<Residual>& residuals) {
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const OutlinePoint& point = view.outline[i];
    residuals[i].view = index;
    residuals[i].pixel = point.pixel;
    residuals[i].normal = point.normal;
    residuals[i].sigma = point.sigma;
    residuals[i].value -= state.edge_offset;
  }
}

std::vector<calib::Pose> PosesOfTable(const rig::RigCalibration& calibration,
                                      const std::vector<View>& views) {
  std::vector<calib::Pose> poses;
  for (const View& view : views)
    poses.push_back(PoseOfTableInCamera(calibration.geometry, view.angle_deg));
  return poses;
}

// The residuals of all views, made in parallel and put together in their order.
template <typename OfView>
std::vector<Residual> OfAllViews(std::size_t count, const OfView& of_view) {
  std::vector<std::vector<Residual>> parts(count);
  ParallelFor(count, [&](std::size_t v) { parts[v] = of_view(v); });
  std::vector<Residual> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace

calib::Pose PoseOfTableInCamera(const calib::TurntableGeometry& geometry, double angle_deg) {
  calib::TurntableGeometry table = geometry;
  table.X_AT = {};
  const calib::RigPoses poses = calib::PosesAt(table, angle_deg);
  return poses.X_WC.Inverse() * poses.X_WT;
}

Row ParameterRow(const Residual& residual, const State& state, const calib::Pose& X_CA) {
  const Vector3d by_p_A = X_CA.rotation.transpose() * residual.by_p_C.transpose();
  Row row;
  row.segment<3>(0) = (residual.p_A - state.X_AT.translation).cross(by_p_A).transpose();
  row.segment<3>(3) = by_p_A.transpose();
  row[kRadius] = residual.by_radius;
  row[kEdgeOffset] = residual.edge ? -1.0 : 0.0;
  return row;
}

Model SphereModel(const rig::RigCalibration& calibration, const std::vector<View>& views) {
  auto sightings = std::make_shared<std::vector<std::vector<Sighting>>>(views.size());
  ParallelFor(views.size(),
              [&](std::size_t v) { (*sightings)[v] = Sight(calibration.lens, views[v]); });
  const std::vector<calib::Pose> X_CA = PosesOfTable(calibration, views);
  return [sightings, X_CA, &views](const State& state, double) {
    return OfAllViews(views.size(), [&](std::size_t v) {
      std::vector<Residual> residuals;
      for (const Sighting& seen : (*sightings)[v]) {
        residuals.push_back(SphereResidual(seen, X_CA[v] * state.X_AT.translation, state.radius));
        residuals.back().p_A = state.X_AT.translation;
      }
      Complete(views[v], v, state, residuals);
      return residuals;
    });
  };
}

Model ContourModel(const rig::RigCalibration& calibration, const calib::TargetShape& shape,
                   const std::vector<View>& views) {
  return ContourModel(calibration, std::make_shared<const ContourFinder>(shape), views);
}

Model ContourModel(const rig::RigCalibration& calibration,
                   std::shared_ptr<const ContourFinder> finder, const std::vector<View>& views) {
  const std::vector<calib::Pose> X_CA = PosesOfTable(calibration, views);
  return [finder, X_CA, &views, &calibration](const State& state, double reach) {
    return OfAllViews(views.size(), [&](std::size_t v) {
      auto residuals = ContourResiduals(*finder, calibration.lens, views[v], X_CA[v], state, reach);
      Complete(views[v], v, state, residuals);
      return residuals;
    });
  };
}

Model PickedModel(const rig::RigCalibration& calibration, const std::vector<View>& views,
                  const std::vector<PickedPoint>& picked, double sigma) {
  const std::vector<calib::Pose> X_CA = PosesOfTable(calibration, views);
  return [X_CA, &calibration, &picked, sigma](const State& state, double) {
    std::vector<Vector3d> p_C;
    for (const PickedPoint& point : picked)
      p_C.push_back(X_CA[point.view] * (state.X_AT * point.p_T));
    const Projections projected = ProjectWithDerivatives(calibration.lens, p_C);
    std::vector<Residual> residuals;
    for (std::size_t i = 0; i < picked.size(); ++i)
      for (const Vector2d& normal : {Vector2d(1, 0), Vector2d(0, 1)}) {
        Residual residual{picked[i].view, picked[i].pixel, normal};
        residual.sigma = sigma;
        residual.edge = false;
        residual.valid = projected.pixel[i].allFinite() && projected.by_p_C[i].allFinite();
        residual.value = normal.dot(picked[i].pixel - projected.pixel[i]);
        residual.by_p_C = -normal.transpose() * projected.by_p_C[i];
        residual.p_A = state.X_AT * picked[i].p_T;
        if (!residual.valid) residual.value = 0.0;
        residuals.push_back(residual);
      }
    return residuals;
  };
}

}  // namespace turnlight::calib::calibrate::placement
