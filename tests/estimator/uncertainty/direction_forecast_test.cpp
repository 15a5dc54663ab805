// Proves in closed form: as much information again makes noise smaller by the root of two, what
// does not shrink stays, inflation stays a factor, columns that are held do not count, and what is
// not determined is infinite until a view determines it; and that without more the forecast is the
// sigma that is stated. Does not prove that a view tells what is predicted: view_information_test
// does.
#include "estimator/uncertainty/direction_forecast.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estimator/uncertainty/uncertainty.h"
#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::uncertainty {
namespace {

// One light whose two coordinates are the unknowns, columns 1 and 3 of four.
DirectionForecast OneLight() {
  DirectionForecast out;
  out.unknowns = {1, 3};
  out.hessian = Eigen::Vector2d(100.0, 400.0).asDiagonal();
  out.variance = 4.0;
  out.lights.resize(1);
  out.lights[0].jacobian = Eigen::Matrix2d::Identity();
  return out;
}

Eigen::MatrixXd More(double first, double second) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Constant(4, 4, 0.0);
  out(0, 0) = 1e9;  // held
  out(1, 1) = first;
  out(3, 3) = second;
  return out;
}

TEST(ForecastDirections, AddsInformation) {
  const DirectionForecast light = OneLight();
  EXPECT_NEAR(ForecastDirections(light)[0], 2.0 / 10.0, 1e-12);
  EXPECT_NEAR(ForecastDirections(light, More(100.0, 0.0))[0], 2.0 / std::sqrt(200.0), 1e-12);
  EXPECT_NEAR(ForecastDirections(light, More(1e9, 0.0))[0], 2.0 / 20.0, 1e-9)
      << "the other axis is the larger one then";
}

TEST(ForecastDirections, WhatDoesNotShrinkStays) {
  DirectionForecast light = OneLight();
  light.lights[0].floor(0, 0) = 0.09;
  light.lights[0].inflation = {2.0, 1.0};
  EXPECT_NEAR(ForecastDirections(light)[0], std::hypot(0.4, 0.3), 1e-12);
  EXPECT_NEAR(ForecastDirections(light, More(1e12, 1e12))[0], 0.3, 1e-6);
  EXPECT_NEAR(FloorOfDirections(light)[0], 0.3, 1e-12);
}

TEST(ForecastDirections, WhatIsNotDeterminedIsInfiniteUntilItIs) {
  DirectionForecast light = OneLight();
  light.hessian(1, 1) = 0.0;
  EXPECT_TRUE(std::isinf(ForecastDirections(light)[0]));
  EXPECT_NEAR(ForecastDirections(light, More(0.0, 400.0))[0], 0.2, 1e-12);
}

TEST(ForecastDirections, WithoutMoreIsTheSigmaThatIsStated) {
  const model::Scene truth = TwoLights();
  RandomObservations drawn(2000, 3, 1, &truth);
  AddNoise(0.01, 1, drawn.observations);
  const solve::Solution solution = solve::Solve(drawn.observations, truth, {});
  const auto order = StrengthOrder(solution.scene, drawn.observations);
  const Uncertainties sigmas = EstimateUncertainty(solution, drawn.observations, order, 1.0,
                                                   SplitResiduals(drawn.observations, solution));
  const std::vector<double> forecast = ForecastDirections(sigmas.forecast);
  ASSERT_EQ(forecast.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_NEAR(forecast[i], sigmas.total.lights[i].direction, 1e-9 * forecast[i]);
  const std::vector<double> twice = ForecastDirections(sigmas.forecast, solution.equations.hessian);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_LT(twice[i], forecast[i]);
    EXPECT_GE(twice[i], 0.999 * forecast[i] / std::sqrt(2.0));
  }
}

}  // namespace
}  // namespace turnlight::estimator::uncertainty
