#include "calib/calibrate/lens/covariance.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <cmath>

namespace turnlight::calib::calibrate::lens {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d CrossMatrix(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// w of Exp(r + dr) = Exp(w) Exp(r) is this times dr.
Matrix3d LeftJacobian(const Vector3d& r) {
  const double angle = r.norm();
  const Matrix3d cross = CrossMatrix(r);
  if (angle < 1e-6) return Matrix3d::Identity() + 0.5 * cross;
  const double squared = angle * angle;
  return Matrix3d::Identity() + (1.0 - std::cos(angle)) / squared * cross +
         (angle - std::sin(angle)) / (squared * angle) * cross * cross;
}

// Derivatives of intrinsics and mean motion by the packed state, one column each.
Eigen::MatrixXd Derivatives(const Problem& problem, const Linearization& linear) {
  const auto intrinsics = static_cast<Index>(problem.intrinsics.size());
  Eigen::MatrixXd derivatives = Eigen::MatrixXd::Zero(linear.scales.size(), intrinsics + 6);
  const Index first = intrinsics - linear.intrinsics_count;  // the core may be held
  for (Index i = 0; i < linear.intrinsics_count; ++i)
    derivatives(linear.intrinsics_index + i, first + i) = 1.0;
  const double share = 1.0 / static_cast<double>(problem.poses.size());
  for (std::size_t view = 0; view < problem.poses.size(); ++view) {
    const mrcal_pose_t& pose = problem.poses[view];
    const Vector3d r(pose.r.x, pose.r.y, pose.r.z), t(pose.t.x, pose.t.y, pose.t.z);
    const Matrix3d turn = share * LeftJacobian(r);
    const Index row = linear.poses_index + 6 * static_cast<Index>(view);
    derivatives.block<3, 3>(row, intrinsics) = turn.transpose();
    derivatives.block<3, 3>(row, intrinsics + 3) = (CrossMatrix(t) * turn).transpose();
    derivatives.block<3, 3>(row + 3, intrinsics + 3) = share * Matrix3d::Identity();
  }
  return linear.scales.asDiagonal() * derivatives;
}

}  // namespace

FitNoise NoiseOf(const Problem& problem, const Linearization& linear) {
  double sum = 0.0, squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < problem.observed.size(); ++i) {
    if (problem.observed[i].z < 0.0) continue;
    for (Index k = 0; k < 2; ++k) {
      const double residual = linear.residuals[2 * static_cast<Index>(i) + k];
      sum += residual;
      squares += residual * residual;
      count += 1.0;
    }
  }
  const double mean = sum / count;
  return {std::sqrt(squares / count), std::sqrt(std::max(0.0, squares / count - mean * mean)),
          static_cast<std::size_t>(linear.scales.size())};
}

std::optional<Eigen::MatrixXd> CalibrationCovariance(const Problem& problem,
                                                     const Linearization& linear, double noise_px) {
  using Sparse = Eigen::SparseMatrix<double>;
  const Sparse jacobian = linear.jacobian;
  const Sparse observed = linear.jacobian.topRows(linear.observation_rows);
  const Sparse all = jacobian.transpose() * jacobian;
  const Sparse information = observed.transpose() * observed;
  const Eigen::SimplicialLDLT<Sparse> factor(all);
  if (factor.info() != Eigen::Success) return std::nullopt;
  if (!(factor.vectorD().minCoeff() > 0.0)) return std::nullopt;
  const Eigen::MatrixXd solved = factor.solve(Derivatives(problem, linear));
  const Eigen::MatrixXd covariance = solved.transpose() * (information * solved);
  if (!covariance.allFinite()) return std::nullopt;
  return noise_px * noise_px * 0.5 * (covariance + covariance.transpose());
}

}  // namespace turnlight::calib::calibrate::lens
