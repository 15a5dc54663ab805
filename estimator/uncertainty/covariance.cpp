#include "estimator/uncertainty/covariance.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "estimator/solve/unit_diagonal.h"

namespace turnlight::estimator::uncertainty {
namespace {

// Eigenvalues of the column-scaled matrix below this share of the largest are rounding: the data
// say nothing about that direction.
constexpr double kNullShare = 1e-11;
constexpr double kWeakShare = 1e-7;

}  // namespace

Covariance InvertInformation(const Eigen::MatrixXd& hessian, double variance) {
  Covariance out;
  out.variance = variance;
  const Eigen::Index n = hessian.rows();
  out.undetermined.assign(static_cast<std::size_t>(n), false);
  out.matrix = Eigen::MatrixXd::Zero(n, n);
  if (n == 0) return out;
  const Eigen::VectorXd scale = hessian.diagonal().cwiseMax(0.0).cwiseSqrt();
  Eigen::MatrixXd scaled(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) {
      const double s = scale[i] * scale[j];
      scaled(i, j) = s > 0.0 ? hessian(i, j) / s : 0.0;
    }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  const double largest = std::max(eigen.eigenvalues().maxCoeff(), 1e-300);
  double smallest = largest;
  for (Eigen::Index k = 0; k < n; ++k) {
    const double value = eigen.eigenvalues()[k];
    const Eigen::VectorXd vector = eigen.eigenvectors().col(k);
    if (value < kWeakShare * largest) out.weak_directions.push_back(vector);
    if (!(value > kNullShare * largest)) {
      for (Eigen::Index i = 0; i < n; ++i)
        if (std::abs(vector[i]) > 1e-3) out.undetermined[static_cast<std::size_t>(i)] = true;
      continue;
    }
    smallest = std::min(smallest, value);
    out.matrix += variance / value * (vector * vector.transpose());
  }
  out.condition = largest / smallest;
  const Eigen::VectorXd inverse = solve::InverseOrZero(scale);
  out.matrix = inverse.asDiagonal() * out.matrix * inverse.asDiagonal();
  return out;
}

double LongerHalfAxis(const Eigen::Matrix2d& covariance) {
  const double larger =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance).eigenvalues().maxCoeff();
  return std::sqrt(std::max(larger, 0.0));
}

}  // namespace turnlight::estimator::uncertainty
