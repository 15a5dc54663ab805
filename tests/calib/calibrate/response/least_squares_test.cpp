// Proves: a straight line has its closed-form solution and covariance, and Rosenbrock's valley
// (1960) is followed to its end.
#include "calib/calibrate/response/least_squares.h"

#include <gtest/gtest.h>

#include <cmath>

namespace turnlight::calib::calibrate::response {
namespace {

TEST(LeastSquares, AStraightLine) {
  const auto residuals = [](const Eigen::VectorXd& p) {
    Eigen::VectorXd out(4);
    for (int i = 0; i < 4; ++i) out[i] = (p[0] + p[1] * i - (i == 3 ? 7.0 : 1.0 + 2.0 * i)) / 0.5;
    return out;
  };
  const LeastSquares fit = Minimise(residuals, Eigen::VectorXd::Zero(2), Eigen::VectorXd::Ones(2));
  EXPECT_NEAR(fit.parameters[0], 1.0, 1e-6);
  EXPECT_NEAR(fit.parameters[1], 2.0, 1e-6);
  // Of x = 0..3: variance of the slope is s^2 / 5, of the intercept s^2 (1/4 + 1.5^2 / 5).
  EXPECT_NEAR(fit.covariance(1, 1), 0.25 / 5.0, 1e-6);
  EXPECT_NEAR(fit.covariance(0, 0), 0.25 * (0.25 + 2.25 / 5.0), 1e-6);
}

TEST(LeastSquares, RosenbrocksValley) {
  const auto residuals = [](const Eigen::VectorXd& p) {
    return Eigen::VectorXd(Eigen::Vector2d(10.0 * (p[1] - p[0] * p[0]), 1.0 - p[0]));
  };
  const LeastSquares fit =
      Minimise(residuals, Eigen::Vector2d(-1.2, 1.0), Eigen::Vector2d(0.1, 0.1));
  EXPECT_NEAR(fit.parameters[0], 1.0, 1e-5);
  EXPECT_NEAR(fit.parameters[1], 1.0, 1e-5);
}

}  // namespace
}  // namespace turnlight::calib::calibrate::response
