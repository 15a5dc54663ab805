// Proves: the scale makes a unit diagonal and stays finite where there is nothing to scale; the
// scaled factor solves what a plain one cannot, and says when it cannot either. Does not prove how
// well conditioned a problem may be.
#include "estimator/solve/unit_diagonal.h"

#include <gtest/gtest.h>

#include <cmath>

namespace turnlight::estimator::solve {
namespace {

// A Hilbert matrix whose rows and columns are in units of very different sizes.
Eigen::MatrixXd UnlikeUnits(const Eigen::VectorXd& units) {
  Eigen::MatrixXd matrix(units.size(), units.size());
  for (Eigen::Index i = 0; i < units.size(); ++i)
    for (Eigen::Index j = 0; j < units.size(); ++j)
      matrix(i, j) = units[i] * units[j] / static_cast<double>(i + j + 1);
  return matrix;
}

TEST(UnitDiagonal, ScalesToOnes) {
  const Eigen::Vector4d units(1e-9, 1.0, 1e12, 30.0);
  const Eigen::MatrixXd matrix = UnlikeUnits(units);
  const auto scale = UnitDiagonalScale(matrix.diagonal());
  const Eigen::MatrixXd scaled = scale.asDiagonal() * matrix * scale.asDiagonal();
  EXPECT_LT((scaled.diagonal() - Eigen::Vector4d::Ones()).norm(), 1e-14);
  EXPECT_TRUE(UnitDiagonalScale(Eigen::Vector2d(0.0, 4.0)).allFinite());
  EXPECT_EQ(UnitDiagonalScale(Eigen::Vector2d(0.0, 4.0))[1], 0.5);
}

TEST(UnitDiagonal, NoScaleNoInverse) {
  EXPECT_EQ(InverseOrZero(Eigen::Vector3d(0.0, 4.0, -1.0)), Eigen::Vector3d(0.0, 0.25, 0.0));
}

TEST(ScaledFactor, SolvesWhateverTheUnits) {
  const Eigen::Vector4d units(1e-9, 1.0, 1e12, 30.0);
  const ScaledFactor factor(UnlikeUnits(units));
  ASSERT_TRUE(factor.Good());
  const Eigen::Vector4d truth = units.cwiseInverse();
  const Eigen::VectorXd solved = factor.Solve(UnlikeUnits(units) * truth);
  EXPECT_LT((solved.cwiseQuotient(truth) - Eigen::Vector4d::Ones()).norm(), 1e-10);
}

TEST(ScaledFactor, SaysWhenAMatrixIsNotPositiveDefinite) {
  EXPECT_FALSE(ScaledFactor(Eigen::Matrix2d{{1.0, 2.0}, {2.0, 1.0}}).Good());
  EXPECT_FALSE(ScaledFactor(Eigen::Matrix2d{{1.0, 0.0}, {0.0, -1.0}}).Good());
}

}  // namespace
}  // namespace turnlight::estimator::solve
