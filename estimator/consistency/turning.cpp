#include "estimator/consistency/turning.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/angles.h"

namespace turnlight::estimator::consistency {
namespace {

using calib::Pose;
using Eigen::Vector3d;

constexpr double kTolerance = 2e-3;
constexpr double kLeastTurnDeg = 5.0;
constexpr double kAngleToleranceDeg = 1.0;

bool Same(const Pose& a, const Pose& b, double scale) {
  return (a.rotation - b.rotation).norm() < 1e-9 &&
         (a.translation - b.translation).norm() < 1e-9 * scale;
}

// Into (-pi, pi].
double Wrapped(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }

Pose AboutLine(const Vector3d& axis, const Vector3d& point, double angle) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  return {turn, point - turn * point};
}

// The first pose to each: rotations about one axis, if it is a turning.
std::vector<Pose> Relative(const std::vector<Pose>& moving) {
  std::vector<Pose> out;
  for (const Pose& pose : moving) out.push_back(pose * moving.front().Inverse());
  return out;
}

// The vector parts of the unit quaternions lie along the axis.
Vector3d CommonAxis(const std::vector<Pose>& relative) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Pose& pose : relative) {
    const Vector3d v = Eigen::Quaterniond(pose.rotation).vec();
    sum += v * v.transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sum).eigenvectors().col(2);
}

Vector3d PointOnAxis(const std::vector<Pose>& relative) {
  Eigen::MatrixXd matrix(3 * static_cast<Eigen::Index>(relative.size()), 3);
  Eigen::VectorXd b(matrix.rows());
  for (std::size_t k = 0; k < relative.size(); ++k) {
    matrix.middleRows<3>(3 * static_cast<Eigen::Index>(k)) =
        Eigen::Matrix3d::Identity() - relative[k].rotation;
    b.segment<3>(3 * static_cast<Eigen::Index>(k)) = relative[k].translation;
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(1e-6);
  solver.compute(matrix);
  return solver.solve(b);
}

double AngleAbout(const Vector3d& axis, const Eigen::Matrix3d& rotation) {
  const Eigen::Quaterniond q(rotation);
  return Wrapped(2.0 * std::atan2(q.vec().dot(axis), q.w()));
}

void Unwrap(std::vector<double>& angles) {
  for (std::size_t k = 1; k < angles.size(); ++k)
    angles[k] = angles[k - 1] + Wrapped(angles[k] - angles[k - 1]);
}

// Takes the session's angles, if the poses follow them one way round or the other.
void Follow(const std::vector<double>& angles_deg, std::vector<double>& angles) {
  if (angles_deg.size() != angles.size()) return;
  for (const double sign : {1.0, -1.0}) {
    const double offset = Wrapped(angles[0] - sign * DegToRad(angles_deg[0]));
    std::vector<double> followed;
    for (std::size_t k = 0; k < angles.size(); ++k) {
      const double named = sign * DegToRad(angles_deg[k]);
      const double beyond = Wrapped(angles[k] - named - offset);
      if (std::abs(beyond) > DegToRad(kAngleToleranceDeg)) break;
      followed.push_back(named + beyond);
    }
    if (followed.size() != angles.size()) continue;
    angles = followed;
    return;
  }
}

bool MostlyFalls(const std::vector<double>& angles) {
  std::ptrdiff_t rises = 0;
  for (std::size_t k = 1; k < angles.size(); ++k) rises += angles[k] > angles[k - 1] ? 1 : -1;
  return rises < 0;
}

double Span(const std::vector<double>& angles) {
  const auto [low, high] = std::minmax_element(angles.begin(), angles.end());
  return *high - *low;
}

}  // namespace

std::optional<Turning> FindTurning(const std::vector<calib::RigPoses>& poses,
                                   const std::vector<double>& angles_deg) {
  if (poses.size() < 3) return std::nullopt;
  double scale = 0.0;
  bool camera_moves = false, target_moves = false;
  for (const calib::RigPoses& pose : poses)
    scale = std::max({scale, pose.X_WC.translation.norm(), pose.X_WT.translation.norm()});
  for (const calib::RigPoses& pose : poses) {
    camera_moves = camera_moves || !Same(pose.X_WC, poses[0].X_WC, scale);
    target_moves = target_moves || !Same(pose.X_WT, poses[0].X_WT, scale);
  }
  if (camera_moves == target_moves) return std::nullopt;
  std::vector<Pose> moving;
  for (const calib::RigPoses& pose : poses) moving.push_back(camera_moves ? pose.X_WC : pose.X_WT);
  const std::vector<Pose> relative = Relative(moving);
  Turning out{camera_moves, CommonAxis(relative), PointOnAxis(relative), {}};
  for (const Pose& pose : relative) out.angle.push_back(AngleAbout(out.axis, pose.rotation));
  for (std::size_t k = 0; k < relative.size(); ++k) {
    const Pose about = AboutLine(out.axis, out.point, out.angle[k]);
    if ((about.rotation - relative[k].rotation).norm() > kTolerance ||
        (about.translation - relative[k].translation).norm() > kTolerance * scale)
      return std::nullopt;
  }
  Unwrap(out.angle);
  if (MostlyFalls(out.angle)) {
    out.axis = -out.axis;
    for (double& angle : out.angle) angle = -angle;
  }
  Follow(angles_deg, out.angle);
  if (Span(out.angle) < DegToRad(kLeastTurnDeg)) return std::nullopt;
  return out;
}

calib::RigPoses Turned(const Turning& turning, const calib::RigPoses& poses, double by) {
  const Pose about = AboutLine(turning.axis, turning.point, by);
  return turning.camera_moves ? calib::RigPoses{about * poses.X_WC, poses.X_WT}
                              : calib::RigPoses{poses.X_WC, about * poses.X_WT};
}

}  // namespace turnlight::estimator::consistency
