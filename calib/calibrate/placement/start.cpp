#include "calib/calibrate/placement/start.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "base/statistics.h"

namespace turnlight::calib::calibrate::placement {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using std::numbers::pi;

constexpr int kRefineSteps = 25;
constexpr std::size_t kRefined = 12;    // of the grid's rotations
constexpr double kSamePlace = 0.05;     // radians between placements that count as one
constexpr std::size_t kPlaneViews = 6;  // whose corners are tried
constexpr int kTurns = 36;              // of a standing mesh
// Lines of sight that differ by less cannot be intersected: 1 / (1 - cos) of half a degree or so.
constexpr double kLeastSpread = 1e-5;

struct Line {
  Vector3d origin, direction;  // in A; unit
};

std::vector<Line> LinesOf(const rig::RigCalibration& calibration, const calib::Pose& X_CA,
                          const std::vector<Vector2d>& pixels) {
  const calib::Pose X_AC = X_CA.Inverse();
  std::vector<Line> lines;
  for (const Vector3d& ray : calibration.lens.Unproject(pixels))
    lines.push_back({X_AC.translation, X_AC.rotation * ray});
  return lines;
}

// The middle of what an outline bounds, in C, and half the angle that it spans.
struct Middle {
  Vector3d ray;
  double half_angle = 0.0;
};

std::optional<Middle> MiddleOf(const calib::CameraModel& camera, const View& view) {
  std::vector<Vector2d> pixels;
  for (const OutlinePoint& point : view.outline) pixels.push_back(point.pixel);
  std::vector<Vector3d> rays = camera.Unproject(pixels);
  std::erase_if(rays, [](const Vector3d& ray) { return !ray.allFinite(); });
  if (rays.size() < 3) return std::nullopt;
  // The plane through the tips of the rays: those tangent to a sphere lie in one, also if a part of
  // the outline is missing.
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& ray : rays) mean += ray / static_cast<double>(rays.size());
  Matrix3d spread = Matrix3d::Zero();
  for (const Vector3d& ray : rays) spread += (ray - mean) * (ray - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(spread);
  Vector3d normal = solver.eigenvectors().col(0);
  if (normal.dot(mean) < 0.0) normal = -normal;
  std::vector<double> angles;
  for (const Vector3d& ray : rays)
    angles.push_back(std::acos(std::clamp(ray.dot(normal), -1.0, 1.0)));
  return Middle{normal, Median(angles)};
}

// Where lines meet, in the least-squares sense; nothing if they are parallel.
std::optional<Vector3d> Intersect(const std::vector<Line>& lines) {
  Matrix3d information = Matrix3d::Zero();
  Vector3d sum = Vector3d::Zero();
  for (const Line& line : lines) {
    const Matrix3d across = Matrix3d::Identity() - line.direction * line.direction.transpose();
    information += across;
    sum += across * line.origin;
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(information);
  if (!(solver.eigenvalues()[0] > kLeastSpread * static_cast<double>(lines.size())))
    return std::nullopt;
  return solver.eigenvectors() *
         (solver.eigenvectors().transpose() * sum).cwiseQuotient(solver.eigenvalues());
}

struct CenterAndRadius {
  Vector3d center_A;
  double radius;
};

// radius 0: unknown.
std::optional<CenterAndRadius> CenterOf(const rig::RigCalibration& calibration,
                                        const std::vector<View>& views, double radius) {
  std::vector<Line> lines;
  std::vector<double> half_angles;
  Vector3d by_size = Vector3d::Zero();
  for (const View& view : views) {
    const auto middle = MiddleOf(calibration.lens, view);
    if (!middle || !(std::sin(middle->half_angle) > 0.0)) continue;
    const calib::Pose X_AC = PoseOfTableInCamera(calibration.geometry, view.angle_deg).Inverse();
    lines.push_back({X_AC.translation, X_AC.rotation * middle->ray});
    half_angles.push_back(middle->half_angle);
    by_size += X_AC * (middle->ray * (radius / std::sin(middle->half_angle)));
  }
  if (lines.empty()) return std::nullopt;
  const auto met = Intersect(lines);
  if (met) {
    std::vector<double> radii;
    for (std::size_t i = 0; i < lines.size(); ++i)
      radii.push_back((*met - lines[i].origin).norm() * std::sin(half_angles[i]));
    return CenterAndRadius{*met, radius > 0.0 ? radius : Median(radii)};
  }
  if (!(radius > 0.0)) return std::nullopt;
  return CenterAndRadius{by_size / static_cast<double>(lines.size()), radius};
}

// Rotations about 20 degrees apart: directions of z times turns about it.
std::vector<Matrix3d> RotationGrid() {
  std::vector<Matrix3d> grid;
  for (int x = -2; x <= 2; ++x)
    for (int y = -2; y <= 2; ++y)
      for (int z = -2; z <= 2; ++z) {
        if (std::max({std::abs(x), std::abs(y), std::abs(z)}) != 2) continue;  // a cube's surface
        const Eigen::Quaterniond tilt =
            Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), Vector3d(x, y, z));
        for (int turn = 0; turn < 12; ++turn)
          grid.push_back(
              (tilt * Eigen::AngleAxisd(turn * pi / 6.0, Vector3d::UnitZ())).toRotationMatrix());
      }
  return grid;
}

// The shift for a rotation, and the mean squared sine between lines and points; infinite if one is
// behind the camera.
std::pair<Vector3d, double> ShiftFor(const Matrix3d& rotation, const std::vector<Line>& lines,
                                     const std::vector<PickedPoint>& picked) {
  Matrix3d information = Matrix3d::Zero();
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Matrix3d across =
        Matrix3d::Identity() - lines[i].direction * lines[i].direction.transpose();
    information += across;
    sum += across * (lines[i].origin - rotation * picked[i].p_T);
  }
  const Vector3d shift = information.ldlt().solve(sum);
  double cost = 0.0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Vector3d from = rotation * picked[i].p_T + shift - lines[i].origin;
    if (!(from.dot(lines[i].direction) > 0.0)) return {shift, INFINITY};
    cost += lines[i].direction.cross(from.normalized()).squaredNorm();
  }
  return {shift, cost};
}

double AngleBetween(const Matrix3d& a, const Matrix3d& b) {
  return Eigen::AngleAxisd(a.transpose() * b).angle();
}

std::vector<State> BestOfGrid(const std::vector<Line>& lines,
                              const std::vector<PickedPoint>& picked) {
  std::vector<std::pair<double, State>> all;
  for (const Matrix3d& rotation : RotationGrid()) {
    const auto [shift, cost] = ShiftFor(rotation, lines, picked);
    if (std::isfinite(cost)) all.push_back({cost, State{{rotation, shift}}});
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<State> best;
  for (const auto& [cost, state] : all) {
    if (best.size() == kRefined) break;
    best.push_back(state);
  }
  return best;
}

bool AllInFront(const rig::RigCalibration& calibration, const std::vector<View>& views,
                const std::vector<PickedPoint>& picked, const State& state) {
  return std::all_of(picked.begin(), picked.end(), [&](const PickedPoint& point) {
    const Vector3d p_C = PoseOfTableInCamera(calibration.geometry, views[point.view].angle_deg) *
                         (state.X_AT * point.p_T);
    return p_C.allFinite() && calibration.lens.Project({p_C})[0].allFinite();
  });
}

std::vector<PickedPoint> AssignCorners(const std::vector<Vector2d>& corners, std::size_t view,
                                       const calib::PlaneShape& plane, int shift, bool reversed) {
  const double x = 0.5 * plane.width, y = 0.5 * plane.height;
  const Vector3d p_T[4] = {{-x, -y, 0.0}, {x, -y, 0.0}, {x, y, 0.0}, {-x, y, 0.0}};
  std::vector<PickedPoint> picked;
  for (int i = 0; i < 4; ++i)
    picked.push_back({view, corners[static_cast<std::size_t>(i)],
                      p_T[(shift + (reversed ? 4 - i : i)) % 4], ""});
  return picked;
}

// Whether a one-sided plane shows its front.
bool Faces(const rig::RigCalibration& calibration, const View& view, const State& state) {
  const calib::Pose X_CT = PoseOfTableInCamera(calibration.geometry, view.angle_deg) * state.X_AT;
  return X_CT.Inverse().translation.z() > 0.0;
}

}  // namespace

std::optional<State> StartSphere(const rig::RigCalibration& calibration,
                                 const std::vector<View>& views, double radius, bool fit_radius) {
  const auto found = CenterOf(calibration, views, fit_radius ? 0.0 : radius);
  if (!found) return std::nullopt;
  return State{{Matrix3d::Identity(), found->center_A}, found->radius};
}

std::vector<State> StartPicked(const rig::RigCalibration& calibration,
                               const std::vector<View>& views,
                               const std::vector<PickedPoint>& picked, double size,
                               std::size_t most) {
  std::vector<Line> lines;
  for (const PickedPoint& point : picked)
    lines.push_back(LinesOf(calibration,
                            PoseOfTableInCamera(calibration.geometry, views[point.view].angle_deg),
                            {point.pixel})[0]);
  for (const Line& line : lines)
    if (!line.direction.allFinite()) return {};
  const Problem problem{calibration,
                        views,
                        PickedModel(calibration, views, picked, 1.0),
                        {true, true, true, true, true, true, false, false},
                        0.0,
                        0.0,
                        size};
  std::vector<std::pair<double, State>> refined;
  for (const State& start : BestOfGrid(lines, picked)) {
    const Fit fit = Solve(problem, start, 0.0, kRefineSteps);
    if (AllInFront(calibration, views, picked, fit.state))
      refined.push_back({LimitedCost(fit.residuals, 1e6), fit.state});
  }
  std::stable_sort(refined.begin(), refined.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<State> distinct;
  for (const auto& one : refined) {
    const State& state = one.second;
    const bool known = std::any_of(distinct.begin(), distinct.end(), [&](const State& other) {
      return AngleBetween(other.X_AT.rotation, state.X_AT.rotation) < kSamePlace;
    });
    if (!known && distinct.size() < most) distinct.push_back(state);
  }
  return distinct;
}

std::optional<std::vector<Vector2d>> FindCorners(const std::vector<OutlinePoint>& outline) {
  std::vector<cv::Point2f> points, hull, corners;
  for (const OutlinePoint& point : outline)
    points.emplace_back(static_cast<float>(point.pixel.x()), static_cast<float>(point.pixel.y()));
  if (points.size() < 8) return std::nullopt;
  cv::convexHull(points, hull);
  const double length = cv::arcLength(hull, true);
  for (double share = 0.01; share < 0.1; share *= 1.3) {
    cv::approxPolyDP(hull, corners, share * length, true);
    if (corners.size() <= 4) break;
  }
  if (corners.size() != 4) return std::nullopt;
  std::vector<Vector2d> found;
  for (const cv::Point2f& corner : corners) found.emplace_back(corner.x, corner.y);
  return found;
}

std::vector<State> StartPlane(const rig::RigCalibration& calibration,
                              const std::vector<View>& views, const calib::PlaneShape& plane) {
  std::vector<std::size_t> order(views.size());
  for (std::size_t v = 0; v < order.size(); ++v) order[v] = v;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return views[a].outline.size() > views[b].outline.size();
  });
  std::vector<State> starts;
  std::size_t tried = 0;
  for (const std::size_t v : order) {
    const auto corners = FindCorners(views[v].outline);
    if (!corners || tried == kPlaneViews) continue;
    ++tried;
    for (int shift = 0; shift < 4; ++shift)
      for (const bool reversed : {false, true})
        for (const State& state :
             StartPicked(calibration, views, AssignCorners(*corners, v, plane, shift, reversed),
                         std::hypot(plane.width, plane.height), 2))
          if (plane.sides == 2 || Faces(calibration, views[v], state)) starts.push_back(state);
  }
  return starts;
}

std::vector<State> StartUpright(const rig::RigCalibration& calibration,
                                const std::vector<View>& views, const Vector3d& center_T,
                                double radius) {
  const auto found = CenterOf(calibration, views, radius);
  if (!found) return {};
  std::vector<State> starts;
  for (int i = 0; i < kTurns; ++i) {
    const Matrix3d rotation =
        Eigen::AngleAxisd(2.0 * pi * i / kTurns, Vector3d::UnitZ()).toRotationMatrix();
    starts.push_back(State{{rotation, found->center_A - rotation * center_T}});
  }
  return starts;
}

}  // namespace turnlight::calib::calibrate::placement
