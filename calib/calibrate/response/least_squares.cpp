#include "calib/calibrate/response/least_squares.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace turnlight::calib::calibrate::response {
namespace {

constexpr int kMostIterations = 60;
constexpr double kDifferenceStep = 1e-4;  // of a sensible step
constexpr double kLeastGain = 1e-10;      // of the cost
constexpr double kMostDamping = 1e10;
constexpr double kRidge = 1e-12;  // of a unit diagonal, for what nothing determines

Eigen::MatrixXd Jacobian(const Residuals& residuals, const Eigen::VectorXd& at,
                         const Eigen::VectorXd& scale, Eigen::Index rows) {
  Eigen::MatrixXd out(rows, at.size());
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    const double step = kDifferenceStep * scale[i];
    Eigen::VectorXd up = at, down = at;
    up[i] += step;
    down[i] -= step;
    out.col(i) = (residuals(up) - residuals(down)) / (2.0 * step);
  }
  return out;
}

}  // namespace

LeastSquares Minimise(const Residuals& residuals, const Eigen::VectorXd& start,
                      const Eigen::VectorXd& scale) {
  LeastSquares out{start, residuals(start), {}};
  double damping = 1e-3;
  const Eigen::Index n = start.size();
  for (int i = 0; i < kMostIterations; ++i) {
    const Eigen::MatrixXd jacobian =
        Jacobian(residuals, out.parameters, scale, out.residuals.size()) * scale.asDiagonal();
    const Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
    const Eigen::VectorXd gradient = jacobian.transpose() * out.residuals;
    const double cost = out.residuals.squaredNorm();
    bool lower = false;
    while (!lower && damping < kMostDamping) {
      Eigen::MatrixXd damped = normal;
      damped.diagonal() += damping * (normal.diagonal().array() + 1e-9).matrix();
      const Eigen::VectorXd step = -damped.ldlt().solve(gradient);
      const Eigen::VectorXd next = out.parameters + scale.cwiseProduct(step);
      const Eigen::VectorXd at_next = residuals(next);
      lower = at_next.allFinite() && at_next.squaredNorm() < cost;
      damping = lower ? std::max(damping * 0.2, 1e-12) : damping * 8.0;
      if (lower) out = {next, at_next, {}};
    }
    if (!lower || cost - out.residuals.squaredNorm() < kLeastGain * cost) break;
  }
  const Eigen::MatrixXd jacobian =
      Jacobian(residuals, out.parameters, scale, out.residuals.size()) * scale.asDiagonal();
  Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
  const Eigen::VectorXd unit =
      normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  normal = unit.asDiagonal() * normal * unit.asDiagonal();
  normal.diagonal().array() += kRidge;
  const Eigen::VectorXd back = scale.cwiseProduct(unit);
  out.covariance = back.asDiagonal() * normal.ldlt().solve(Eigen::MatrixXd::Identity(n, n)) *
                   back.asDiagonal();
  return out;
}

}  // namespace turnlight::calib::calibrate::response
