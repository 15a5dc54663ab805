// Proves: the curve goes through its points, only rises, is its own inverse's inverse, goes on
// straight beyond its ends, and follows a smooth function as closely as a cubic does. Does not prove:
// that a sensor is such a curve.
#include "calib/monotone_curve.h"

#include <gtest/gtest.h>

#include <cmath>

namespace turnlight::calib {
namespace {

const std::vector<std::array<double, 2>> kPoints{
    {0.0, 0.0}, {0.1, 0.02}, {0.3, 0.05}, {0.5, 0.6}, {1.0, 1.0}};

TEST(MonotoneCurve, GoesThroughItsPointsAndOnlyRises) {
  const MonotoneCurve curve(kPoints);
  for (const auto& [x, y] : kPoints) EXPECT_NEAR(curve.At(x), y, 1e-15);
  double before = curve.At(-0.51);
  for (double x = -0.5; x < 1.5; x += 0.001) {
    const double y = curve.At(x);
    EXPECT_GT(y, before) << x;
    EXPECT_NEAR(curve.InverseAt(y), x, 1e-12) << x;
    before = y;
  }
}

TEST(MonotoneCurve, GoesOnStraight) {
  const MonotoneCurve curve(kPoints);
  const double slope = curve.At(-1.0) / -1.0;
  EXPECT_GT(slope, 0.0);
  EXPECT_NEAR(curve.At(-0.5), -0.5 * slope, 1e-15);
  EXPECT_NEAR(curve.At(1e-9) / 1e-9, slope, 1e-6);
}

TEST(MonotoneCurve, TwoPointsAreALine) {
  const MonotoneCurve line({{0.0, 0.0}, {1.0, 1.0}});
  for (const double x : {-0.3, 0.0, 0.25, 1.0, 1.7}) EXPECT_NEAR(line.At(x), x, 1e-15);
}

TEST(MonotoneCurve, FollowsASmoothFunction) {
  std::vector<std::array<double, 2>> points;
  for (int i = 0; i <= 32; ++i) points.push_back({i / 32.0, std::pow(i / 32.0, 2.2)});
  const MonotoneCurve curve(points);
  for (double x = 0.0; x <= 1.0; x += 0.003)
    EXPECT_NEAR(curve.At(x), std::pow(x, 2.2), 1e-4) << x;
}

}  // namespace
}  // namespace turnlight::calib
