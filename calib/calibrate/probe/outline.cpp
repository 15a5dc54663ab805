#include "calib/calibrate/probe/outline.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "base/format.h"
#include "base/random.h"
#include "base/statistics.h"
#include "calib/calibrate/probe/ball.h"

namespace turnlight::calib::calibrate::probe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t kMinPoints = 20;
constexpr double kMinShare = 0.25;  // of the circumference: less hardly tells the radius
constexpr double kAgreePx = 1.5;    // of a point with the outline
constexpr int kSectors = 36;  // of the circumference: what is next to each other errs together
constexpr double kLopsidedPx = 0.05;  // of an outline whose background is bright on one side
constexpr int kDraws = 400;           // of three points

// Rays at half-angle `opening` about the axis.
struct Cone {
  Vector3d axis = Vector3d::UnitZ();
  double opening = 0.1;
};

// Through three rays: b . m = 1 with m = axis / cos(opening).
std::optional<Cone> ThroughThree(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  Matrix3d rows;
  rows << a.transpose(), b.transpose(), c.transpose();
  if (std::abs(rows.determinant()) < 1e-12) return std::nullopt;
  const Vector3d m = rows.inverse() * Vector3d::Ones();
  if (!m.allFinite() || !(m.norm() > 1.0)) return std::nullopt;
  return Cone{m.normalized(), std::acos(1.0 / m.norm())};
}

double Miss(const Cone& cone, const Vector3d& ray) {
  return std::atan2(ray.cross(cone.axis).norm(), ray.dot(cone.axis)) - cone.opening;
}

std::size_t Agreeing(const Cone& cone, const std::vector<Vector3d>& rays, double within) {
  return static_cast<std::size_t>(std::count_if(rays.begin(), rays.end(), [&](const Vector3d& ray) {
    return std::abs(Miss(cone, ray)) < within;
  }));
}

std::optional<Cone> BestOfThrees(const std::vector<Vector3d>& rays, double within) {
  const RandomStream random(1, 0);
  std::optional<Cone> best;
  std::size_t most = 0;
  const auto pick = [&](int index) {
    const double share = random.Uniform(static_cast<std::uint64_t>(index));
    return rays[std::min(rays.size() - 1,
                         static_cast<std::size_t>(share * static_cast<double>(rays.size())))];
  };
  for (int i = 0; i < kDraws; ++i) {
    const auto cone = ThroughThree(pick(3 * i), pick(3 * i + 1), pick(3 * i + 2));
    if (!cone) continue;
    const std::size_t count = Agreeing(*cone, rays, within);
    if (count <= most) continue;
    most = count;
    best = cone;
  }
  return best;
}

int SectorOf(const Cone& cone, const Vector3d& ray) {
  const Eigen::Matrix<double, 3, 2> across = Across(cone.axis);
  const double azimuth = std::atan2(ray.dot(across.col(1)), ray.dot(across.col(0)));
  return std::clamp(static_cast<int>((azimuth / (2.0 * std::numbers::pi) + 0.5) * kSectors), 0,
                    kSectors - 1);
}

struct Refined {
  Cone cone;
  Matrix3d covariance =
      Matrix3d::Zero();  // of steps of the axis along Across(axis), and the opening
  double rms = 0.0;      // radians
  std::size_t points = 0;
  int sectors = 0;
};

// Least squares of the points that agree, which are chosen anew each time. Sigmas: residuals of a
// sector count together.
Refined Refine(const Cone& start, const std::vector<Vector3d>& rays, double within) {
  Refined refined;
  refined.cone = start;
  constexpr int kRounds = 10;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::Matrix<double, 3, 2> across = Across(refined.cone.axis);
    Matrix3d matrix = Matrix3d::Zero();
    std::array<Vector3d, kSectors> scores;
    scores.fill(Vector3d::Zero());
    std::array<bool, kSectors> seen{};
    Vector3d gradient = Vector3d::Zero();
    double squares = 0.0;
    refined.points = 0;
    for (const Vector3d& ray : rays) {
      const double miss = Miss(refined.cone, ray);
      if (std::abs(miss) > within) continue;
      const Vector2d sideways = (across.transpose() * ray).normalized();
      const Vector3d jacobian(-sideways.x(), -sideways.y(), -1.0);
      matrix += jacobian * jacobian.transpose();
      gradient += miss * jacobian;
      const int sector = SectorOf(refined.cone, ray);
      scores[sector] += miss * jacobian;
      seen[sector] = true;
      squares += miss * miss;
      ++refined.points;
    }
    if (refined.points < kMinPoints) return refined;
    const Matrix3d inverse = matrix.inverse();
    const Vector3d step = -(inverse * gradient);
    refined.cone.axis = (refined.cone.axis + across * step.head<2>()).normalized();
    refined.cone.opening += step[2];
    refined.rms = std::sqrt(squares / static_cast<double>(refined.points));
    refined.sectors = static_cast<int>(std::count(seen.begin(), seen.end(), true));
    Matrix3d middle = Matrix3d::Zero();
    for (const Vector3d& score : scores) middle += score * score.transpose();
    const double freedom = std::max(1, refined.sectors - 3);
    refined.covariance = inverse * middle * inverse * (refined.sectors / freedom);
  }
  return refined;
}

// Where along equally spaced values, which span so many pixels, they change most over about two
// pixels: the centre of gravity of what changes at least half as much. Nothing if nothing does.
std::optional<double> MiddleOfStep(const std::vector<double>& values, double span_px) {
  const std::size_t count = values.size();
  const std::size_t half = static_cast<std::size_t>(
      std::clamp(std::lround(static_cast<double>(count - 1) / std::max(span_px, 1.0)), 1L, 20L));
  std::vector<double> steps(count, 0.0);
  for (std::size_t k = half; k + half < count; ++k) {
    const double step = std::abs(values[k + half] - values[k - half]);
    if (std::isfinite(step)) steps[k] = step;
  }
  const auto steepest = std::max_element(steps.begin(), steps.end());
  if (!(*steepest > 0.0)) return std::nullopt;
  const std::size_t top = static_cast<std::size_t>(steepest - steps.begin());
  std::size_t first = top, last = top;
  while (first > 0 && steps[first - 1] > 0.5 * *steepest) --first;
  while (last + 1 < count && steps[last + 1] > 0.5 * *steepest) ++last;
  double sum = 0.0, moment = 0.0;
  for (std::size_t k = first; k <= last; ++k) {
    const double weight = steps[k] - 0.5 * *steepest;
    sum += weight;
    moment += weight * static_cast<double>(k);
  }
  const double middle = sum > 0.0 ? moment / sum : static_cast<double>(top);
  return std::min(middle, static_cast<double>(count) - 1.001);
}

OutlineBall BallOf(const Refined& refined, double radius, double per_pixel, double step_px) {
  OutlineBall ball;
  const double distance = radius / std::sin(refined.cone.opening);
  ball.center_C = distance * refined.cone.axis;
  Matrix3d covariance = refined.covariance;
  covariance.topLeftCorner<2, 2>() +=
      kLopsidedPx * kLopsidedPx * per_pixel * per_pixel * Eigen::Matrix2d::Identity();
  covariance(2, 2) += step_px * step_px * per_pixel * per_pixel;
  Matrix3d by;
  by.leftCols<2>() = distance * Across(refined.cone.axis);
  by.col(2) = -distance / std::tan(refined.cone.opening) * refined.cone.axis;
  ball.covariance = by * covariance * by.transpose();
  ball.rms_px = refined.rms / per_pixel;
  ball.points = refined.points;
  ball.share_seen = static_cast<double>(refined.sectors) / kSectors;
  return ball;
}

}  // namespace

std::vector<Vector2d> MaskOutline(const cv::Mat1b& mask) {
  std::vector<Vector2d> outline;
  for (int row = 0; row < mask.rows; ++row) {
    for (int column = 0; column < mask.cols; ++column) {
      const bool here = mask(row, column) > 0;
      if (column + 1 < mask.cols && (mask(row, column + 1) > 0) != here)
        outline.push_back({column + 0.5, row});
      if (row + 1 < mask.rows && (mask(row + 1, column) > 0) != here)
        outline.push_back({column, row + 0.5});
    }
  }
  return outline;
}

std::vector<Vector2d> EdgeOutline(const cv::Mat1f& grey, const CameraModel& camera,
                                  const Vector3d& guess_C, double radius) {
  std::vector<Vector2d> outline;
  const double distance = guess_C.norm();
  if (!(distance > radius)) return outline;
  const Vector3d axis = guess_C / distance;
  const Eigen::Matrix<double, 3, 2> across = Across(axis);
  const double opening = std::asin(radius / distance);
  constexpr int kAround = 360, kAcross = 121;
  constexpr double kReach = 0.1;  // of the opening, to either side
  for (int i = 0; i < kAround; ++i) {
    const double azimuth = 2.0 * std::numbers::pi * i / kAround;
    const Vector3d side = across * Vector2d(std::cos(azimuth), std::sin(azimuth));
    std::vector<Vector3d> rays;
    for (int k = 0; k < kAcross; ++k) {
      const double angle = opening * (1.0 + kReach * (2.0 * k / (kAcross - 1) - 1.0));
      rays.push_back(std::cos(angle) * axis + std::sin(angle) * side);
    }
    const auto points = camera.Project(rays);
    std::vector<double> values;
    for (const Vector2d& point : points) {
      if (!(point.x() >= 0.0) || !(point.y() >= 0.0) || !(point.x() < grey.cols - 1) ||
          !(point.y() < grey.rows - 1))
        break;
      const int column = static_cast<int>(point.x()), row = static_cast<int>(point.y());
      const double u = point.x() - column, v = point.y() - row;
      values.push_back((1.0 - v) * ((1.0 - u) * grey(row, column) + u * grey(row, column + 1)) +
                       v * ((1.0 - u) * grey(row + 1, column) + u * grey(row + 1, column + 1)));
    }
    if (values.size() < points.size()) continue;
    if (const auto at = MiddleOfStep(values, (points.back() - points.front()).norm())) {
      const std::size_t k = static_cast<std::size_t>(*at);
      const double between = *at - static_cast<double>(k);
      outline.push_back((1.0 - between) * points[k] + between * points[k + 1]);
    }
  }
  return outline;
}

Result<OutlineBall> FitOutline(const std::vector<Vector2d>& outline, const CameraModel& camera,
                               double radius, double step_px, const std::string& what) {
  std::vector<Vector3d> rays;
  for (const Vector3d& ray : camera.Unproject(outline))
    if (ray.allFinite()) rays.push_back(ray);
  if (rays.size() < kMinPoints)
    return InputError(what +
                      Format(": the ball's outline has %zu points, allowed are at least %zu: "
                             "give a mask, or a pose near the ball's place",
                             rays.size(), kMinPoints));
  const Vector2d middle = camera.Project({rays.front()}).front();
  const auto beside = camera.Unproject({middle, middle + Vector2d(1.0, 0.0)});
  const double per_pixel = (beside[1] - beside[0]).norm();
  const double within = kAgreePx * per_pixel;
  const auto start = BestOfThrees(rays, within);
  if (!start || 2 * Agreeing(*start, rays, within) < rays.size())
    return InputError(what +
                      ": the outline is not a ball's: no circular cone has half of its "
                      "points on it");
  const Refined refined = Refine(*start, rays, within);
  const double share = static_cast<double>(refined.sectors) / kSectors;
  if (refined.points < kMinPoints || share < kMinShare)
    return InputError(what +
                      Format(": %.0f %% of the ball's outline are seen, allowed are at least "
                             "%.0f %%: move the ball into the picture",
                             100.0 * share, 100.0 * kMinShare));
  const OutlineBall ball = BallOf(refined, radius, per_pixel, step_px);
  if (!ball.center_C.allFinite() || !(ball.center_C.z() > 0.0))
    return InputError(what + ": the outline's ball is not in front of the camera");
  return ball;
}

}  // namespace turnlight::calib::calibrate::probe
