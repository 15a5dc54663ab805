#include "estimator/from_session/independent_directions.h"

#include <Eigen/Eigenvalues>

namespace turnlight::estimator::from_session {
namespace {

// Eigenvalues of a correlation below this are rounding.
constexpr double kRoundingShare = 1e-9;

}  // namespace

BlockRoot RootOf(const Eigen::MatrixXd& covariance) {
  if (covariance.size() == 0) return {covariance, covariance};
  const Eigen::VectorXd sigma = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd inverse = sigma.unaryExpr([](double s) { return s > 0.0 ? 1.0 / s : 0.0; });
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(inverse.asDiagonal() * covariance *
                                                             inverse.asDiagonal());
  const Eigen::VectorXd& values = eigen.eigenvalues();
  const double least = kRoundingShare * std::max(values.maxCoeff(), 0.0);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = values.size() - 1; i >= 0; --i)
    if (values[i] > least) kept.push_back(i);
  const auto count = static_cast<Eigen::Index>(kept.size());
  BlockRoot out{Eigen::MatrixXd(sigma.size(), count), Eigen::MatrixXd(count, sigma.size())};
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index i = kept[static_cast<std::size_t>(k)];
    const double root = std::sqrt(values[i]);
    out.root.col(k) = root * sigma.cwiseProduct(eigen.eigenvectors().col(i));
    out.inverse.row(k) = (inverse.cwiseProduct(eigen.eigenvectors().col(i)) / root).transpose();
  }
  return out;
}

Eigen::MatrixXd JointRoot(const Eigen::MatrixXd& covariance, const std::vector<BlockRoot>& blocks) {
  Eigen::Index directions = 0;
  for (const BlockRoot& block : blocks) directions += block.root.cols();
  Eigen::MatrixXd root = Eigen::MatrixXd::Zero(covariance.rows(), directions);
  Eigen::MatrixXd inverse = root.transpose();
  Eigen::Index row = 0, column = 0;
  for (const BlockRoot& block : blocks) {
    root.block(row, column, block.root.rows(), block.root.cols()) = block.root;
    inverse.block(column, row, block.root.cols(), block.root.rows()) = block.inverse;
    row += block.root.rows();
    column += block.root.cols();
  }
  if (directions == 0) return root;
  const Eigen::MatrixXd correlation = inverse * covariance * inverse.transpose();
  if (correlation.isIdentity(kRoundingShare)) return root;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(correlation);
  return root * eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

}  // namespace turnlight::estimator::from_session
