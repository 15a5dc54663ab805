#include "calib/calibrate/handheld/plane_pose.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <optional>
#include <string>

#include "base/angles.h"
#include "base/format.h"

namespace turnlight::calib::calibrate::handheld {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kMaxOffAxisDeg = 85.0;
// Of the smaller half-axis of the points' spread to the larger one: below, they lie on a line.
constexpr double kLeastBreadth = 1e-3;
constexpr int kMostIterations = 60;
constexpr const char* kNoPose =
    "from no place would the camera see the points where the picture has them: is it this board, "
    "or target, and this lens?";

Pose Moved(const Pose& pose, const Vector6& step) {
  const Eigen::Vector3d w = step.head<3>();
  const double angle = w.norm();
  Pose moved = pose;
  if (angle > 0.0)
    moved.rotation = Eigen::AngleAxisd(angle, w / angle).toRotationMatrix() * pose.rotation;
  moved.translation += step.tail<3>();
  return moved;
}

// (pixel seen - pixel predicted) / spread; nothing if a point cannot be projected.
std::optional<Eigen::VectorXd> Residuals(const CameraModel& camera,
                                         const std::vector<SeenPosition>& points,
                                         const Pose& X_CB) {
  std::vector<Eigen::Vector3d> p_C;
  p_C.reserve(points.size());
  for (const SeenPosition& point : points)
    p_C.push_back(X_CB * Eigen::Vector3d(point.p_B.x(), point.p_B.y(), 0.0));
  const auto pixels = camera.Project(p_C);
  Eigen::VectorXd residuals(2 * points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    residuals.segment<2>(2 * static_cast<Eigen::Index>(i)) =
        (points[i].pixel - pixels[i]) / points[i].spread;
  if (!residuals.allFinite()) return std::nullopt;
  return residuals;
}

// Central differences by rotation (radians) and shift; the lens is smooth far below these steps.
std::optional<Eigen::MatrixXd> Jacobian(const CameraModel& camera,
                                        const std::vector<SeenPosition>& points, const Pose& X_CB) {
  Eigen::MatrixXd jacobian(2 * points.size(), 6);
  const double shift = 1e-6 * std::max(X_CB.translation.norm(), 1e-12);
  for (int k = 0; k < 6; ++k) {
    Vector6 step = Vector6::Zero();
    step[k] = k < 3 ? 1e-6 : shift;
    const auto ahead = Residuals(camera, points, Moved(X_CB, step));
    const auto behind = Residuals(camera, points, Moved(X_CB, -step));
    if (!ahead || !behind) return std::nullopt;
    jacobian.col(k) = (*ahead - *behind) / (2.0 * step[k]);
  }
  return jacobian;
}

struct Refined {
  Pose X_CB;
  double cost = std::numeric_limits<double>::infinity();  // sum of squared residuals
  Matrix6 normal_matrix = Matrix6::Zero();
};

// Levenberg and Marquardt's steps until one gains less than rounding.
std::optional<Refined> Refine(const CameraModel& camera, const std::vector<SeenPosition>& points,
                              const Pose& start) {
  Refined best{start};
  auto residuals = Residuals(camera, points, start);
  if (!residuals) return std::nullopt;
  best.cost = residuals->squaredNorm();
  double damping = 1e-6;
  for (int i = 0; i < kMostIterations && damping < 1e12; ++i) {
    const auto jacobian = Jacobian(camera, points, best.X_CB);
    if (!jacobian) return std::nullopt;
    best.normal_matrix = jacobian->transpose() * *jacobian;
    const Vector6 gradient = jacobian->transpose() * *residuals;
    Matrix6 damped = best.normal_matrix;
    damped.diagonal() *= 1.0 + damping;
    const Pose moved = Moved(best.X_CB, damped.ldlt().solve(-gradient));
    const auto there = Residuals(camera, points, moved);
    if (!there || there->squaredNorm() >= best.cost) {
      damping *= 30.0;
      continue;
    }
    const bool settled = best.cost - there->squaredNorm() <= 1e-14 * best.cost;
    best.X_CB = moved;
    best.cost = there->squaredNorm();
    residuals = there;
    damping = std::max(damping / 10.0, 1e-12);
    if (settled) break;
  }
  return best;
}

Status CheckRay(const Eigen::Vector3d& ray, const Eigen::Vector2d& pixel) {
  constexpr const char* kBring = "; bring the plane nearer to the picture's middle";
  const std::string point = Format("the point at pixel %.1f, %.1f lies ", pixel.x(), pixel.y());
  if (!ray.allFinite()) return InputError(point + "where the lens model does not reach" + kBring);
  if (ray.z() < std::cos(DegToRad(kMaxOffAxisDeg)))
    return InputError(point +
                      Format("%.0f degrees off the lens's axis, allowed are at most %g",
                             RadToDeg(std::acos(std::max(ray.z(), -1.0))), kMaxOffAxisDeg) +
                      kBring);
  return {};
}

// Both poses that fit the rays about equally well, the better one first.
Result<std::vector<Pose>> Starts(const CameraModel& camera,
                                 const std::vector<SeenPosition>& points) {
  std::vector<Eigen::Vector2d> pixels;
  std::vector<cv::Point3d> places;
  for (const SeenPosition& point : points) {
    pixels.push_back(point.pixel);
    places.emplace_back(point.p_B.x(), point.p_B.y(), 0.0);
  }
  std::vector<cv::Point2d> seen;
  const std::vector<Eigen::Vector3d> rays = camera.Unproject(pixels);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (const Status good = CheckRay(rays[i], pixels[i]); !good) return Forward(good);
    seen.emplace_back(rays[i].x() / rays[i].z(), rays[i].y() / rays[i].z());
  }
  std::vector<cv::Mat> rotations, shifts;
  try {
    cv::solvePnPGeneric(places, seen, cv::Matx33d::eye(), cv::noArray(), rotations, shifts, false,
                        cv::SOLVEPNP_IPPE);
  } catch (const cv::Exception&) {
    return InputError(kNoPose);
  }
  std::vector<Pose> starts;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const Eigen::Vector3d w(rotations[i].at<double>(0), rotations[i].at<double>(1),
                            rotations[i].at<double>(2));
    Vector6 step;
    step << w, shifts[i].at<double>(0), shifts[i].at<double>(1), shifts[i].at<double>(2);
    if (step.allFinite() && step[5] > 0.0) starts.push_back(Moved(Pose{}, step));
  }
  return starts;
}

Status CheckPoints(const std::vector<SeenPosition>& points) {
  if (points.size() < 4)
    return InputError(Format("%zu points, allowed is 4 or more", points.size()));
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const SeenPosition& point : points) mean += point.p_B;
  mean /= static_cast<double>(points.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const SeenPosition& point : points)
    spread += (point.p_B - mean) * (point.p_B - mean).transpose();
  const Eigen::Vector2d squares =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvalues();
  if (!(squares[0] > kLeastBreadth * kLeastBreadth * squares[1]))
    return InputError("the points lie on a line, which leaves the pose open");
  return {};
}

double RmsOf(double cost, std::size_t points) {
  // Four points leave two degrees of freedom.
  return std::sqrt(cost / static_cast<double>(2 * points - 6));
}

}  // namespace

Result<PlanePose> EstimatePlanePose(const CameraModel& camera,
                                    const std::vector<SeenPosition>& points, double pixel_sigma) {
  if (const Status good = CheckPoints(points); !good) return Forward(good);
  const auto starts = Starts(camera, points);
  if (!starts) return Forward(starts);
  std::vector<Refined> found;
  for (const Pose& start : *starts)
    if (const auto refined = Refine(camera, points, start)) found.push_back(*refined);
  if (found.empty()) return InputError(kNoPose);
  std::sort(found.begin(), found.end(),
            [](const Refined& a, const Refined& b) { return a.cost < b.cost; });
  const Refined& best = found.front();
  PlanePose pose{best.X_CB};
  pose.rms_px = RmsOf(best.cost, points.size());
  const double sigma = std::max(pixel_sigma, pose.rms_px);
  pose.covariance = sigma * sigma * best.normal_matrix.ldlt().solve(Matrix6::Identity());
  pose.mirrored_ratio = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < found.size(); ++i) {
    // Both starts may have come to the same pose.
    const Eigen::AngleAxisd apart(best.X_CB.rotation.transpose() * found[i].X_CB.rotation);
    if (std::abs(apart.angle()) < DegToRad(0.5)) continue;
    const double other = std::max(RmsOf(found[i].cost, points.size()), 1e-9);
    pose.mirrored_ratio = std::min(pose.mirrored_ratio, other / std::max(sigma, 1e-9));
  }
  if (!pose.covariance.allFinite())
    return InputError(
        "the points that are seen do not tell where the camera is: show more of the plane, from "
        "closer or more at a slant");
  return pose;
}

}  // namespace turnlight::calib::calibrate::handheld
