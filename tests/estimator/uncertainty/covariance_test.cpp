// Proves: what is inverted is the inverse, whatever the units; a direction that the data do not see
// is left out and told; a half-axis is that of the ellipse. Does not prove what it is used for:
// uncertainty_test does.
#include "estimator/uncertainty/covariance.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

namespace turnlight::estimator::uncertainty {
namespace {

TEST(InvertInformation, IsTheInverseInAnyUnits) {
  Eigen::Matrix3d hessian;
  hessian << 4.0, 1e3, 0.0, 1e3, 9e6, 2.0, 0.0, 2.0, 1e-4;
  const Covariance covariance = InvertInformation(hessian, 0.25);
  const Eigen::Matrix3d expected = 0.25 * hessian.inverse();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      EXPECT_NEAR(covariance.matrix(i, j), expected(i, j),
                  1e-9 * std::sqrt(expected(i, i) * expected(j, j)));
  EXPECT_TRUE(covariance.weak_directions.empty());
  EXPECT_EQ(covariance.undetermined, std::vector<bool>(3, false));
  EXPECT_EQ(covariance.variance, 0.25);
}

TEST(InvertInformation, LeavesOutWhatIsNotSeen) {
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  hessian.topLeftCorner<2, 2>() << 1.0, 1.0, 1.0, 1.0;  // only the sum is seen
  hessian(2, 2) = 5.0;
  const Covariance covariance = InvertInformation(hessian, 1.0);
  EXPECT_EQ(covariance.undetermined, (std::vector<bool>{true, true, false}));
  EXPECT_EQ(covariance.weak_directions.size(), 1u);
  EXPECT_NEAR(covariance.matrix(2, 2), 0.2, 1e-12);
}

TEST(InvertInformation, OfNothingIsNothing) {
  EXPECT_EQ(InvertInformation(Eigen::MatrixXd(), 1.0).matrix.size(), 0);
}

TEST(LongerHalfAxis, IsThatOfTheEllipse) {
  const double c = std::cos(0.7), s = std::sin(0.7);
  Eigen::Matrix2d turn;
  turn << c, -s, s, c;
  const Eigen::Matrix2d axes = Eigen::Vector2d(0.04, 9.0).asDiagonal();
  EXPECT_NEAR(LongerHalfAxis(turn * axes * turn.transpose()), 3.0, 1e-12);
  EXPECT_EQ(LongerHalfAxis(Eigen::Matrix2d::Zero()), 0.0);
}

}  // namespace
}  // namespace turnlight::estimator::uncertainty
