// Symmetric matrices scaled to a unit diagonal, without which sums of squares of unlike units
// cannot be inverted safely.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace turnlight::estimator::solve {

// s with which s_i M_ij s_j has a unit diagonal. Where the diagonal of M is 0, s is finite.
template <typename Diagonal>
auto UnitDiagonalScale(const Diagonal& diagonal) {
  return diagonal.cwiseMax(1e-300).cwiseSqrt().cwiseInverse().eval();
}

// 1 / s, or 0 where s is not above 0: what has no scale does not move.
inline Eigen::VectorXd InverseOrZero(const Eigen::VectorXd& s) {
  return s.unaryExpr([](double value) { return value > 0.0 ? 1.0 / value : 0.0; });
}

// The Cholesky factor of a scaled matrix, to be solved with.
class ScaledFactor {
 public:
  explicit ScaledFactor(const Eigen::MatrixXd& matrix)
      : scale_(UnitDiagonalScale(matrix.diagonal())),
        llt_(scale_.asDiagonal() * matrix * scale_.asDiagonal()) {}
  // False if the matrix is not positive definite: then Solve must not be asked.
  bool Good() const { return llt_.info() == Eigen::Success; }
  Eigen::VectorXd Solve(const Eigen::VectorXd& right) const {
    return scale_.asDiagonal() * llt_.solve(scale_.asDiagonal() * right);
  }

 private:
  Eigen::VectorXd scale_;
  Eigen::LLT<Eigen::MatrixXd> llt_;
};

}  // namespace turnlight::estimator::solve
