#include "calib/calibrate/board/homography.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

namespace turnlight::calib::calibrate::board {
namespace {

// Moves points to mean 0 and mean distance sqrt(2).
Eigen::Matrix3d Normaliser(const std::vector<Eigen::Vector2d>& points) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const auto& p : points) mean += p / static_cast<double>(points.size());
  double distance = 0.0;
  for (const auto& p : points) distance += (p - mean).norm() / static_cast<double>(points.size());
  const double scale = distance > 0.0 ? std::sqrt(2.0) / distance : 1.0;
  Eigen::Matrix3d normaliser = Eigen::Matrix3d::Identity();
  normaliser.diagonal() << scale, scale, 1.0;
  normaliser.topRightCorner<2, 1>() = -scale * mean;
  return normaliser;
}

}  // namespace

std::optional<Eigen::Matrix3d> FitHomography(const std::vector<Eigen::Vector2d>& from,
                                             const std::vector<Eigen::Vector2d>& to,
                                             const std::vector<double>& weights) {
  if (from.size() < 4) return std::nullopt;
  const Eigen::Matrix3d a = Normaliser(from);
  const Eigen::Matrix3d b = Normaliser(to);
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Eigen::RowVector3d p = Map(a, from[i]).homogeneous().transpose();
    const Eigen::Vector2d q = Map(b, to[i]);
    Eigen::Matrix<double, 2, 9> rows = Eigen::Matrix<double, 2, 9>::Zero();
    rows.block<1, 3>(0, 0) = p;
    rows.block<1, 3>(0, 6) = -q.x() * p;
    rows.block<1, 3>(1, 3) = p;
    rows.block<1, 3>(1, 6) = -q.y() * p;
    normal += (weights.empty() ? 1.0 : weights[i]) * rows.transpose() * rows;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(normal);
  constexpr double kSingular = 1e-12;  // of the largest eigenvalue
  if (!(solver.eigenvalues()[1] > kSingular * solver.eigenvalues()[8])) return std::nullopt;
  const Eigen::Matrix<double, 9, 1> h = solver.eigenvectors().col(0);
  Eigen::Matrix3d normalised;
  normalised << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8];
  const Eigen::Matrix3d homography = b.inverse() * normalised * a;
  if (!homography.allFinite()) return std::nullopt;
  return homography;
}

}  // namespace turnlight::calib::calibrate::board
