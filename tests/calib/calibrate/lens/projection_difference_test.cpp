// Proves: a rotation between two lenses is found and taken off exactly, the weights count, and what
// cannot be compared is refused.
#include "calib/calibrate/lens/projection_difference.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "simulated_views.h"

namespace turnlight::calib::calibrate::lens {
namespace {

double Largest(const LensDifference& difference) {
  double largest = 0.0;
  for (const Eigen::Vector2d& px : difference.px) largest = std::max(largest, px.norm());
  return largest;
}

TEST(ProjectionDifference, OfALensToItselfIsNothing) {
  const ImageGrid grid = GridOverImage(2000, 1400, 20);
  EXPECT_EQ(grid.rows, 14);
  EXPECT_EQ(grid.pixels.back(), Eigen::Vector2d(1999.0, 1399.0));
  const auto difference = ProjectionDifference(ExampleLens(), ExampleLens(), grid.pixels,
                                               std::vector<double>(grid.pixels.size(), 1.0));
  ASSERT_TRUE(difference);
  EXPECT_LT(Largest(*difference), 1e-6);
}

TEST(ProjectionDifference, AShiftedCentreIsARotation) {
  // Of a lens so long that shifting its centre and turning it are the same.
  const CameraModel a = CameraModel::Pinhole(1000, 800, 2e5, 2e5, 500.0, 400.0);
  const CameraModel b = CameraModel::Pinhole(1000, 800, 2e5, 2e5, 530.0, 380.0);
  const ImageGrid grid = GridOverImage(1000, 800, 20);
  const auto difference =
      ProjectionDifference(a, b, grid.pixels, std::vector<double>(grid.pixels.size(), 1.0));
  ASSERT_TRUE(difference);
  EXPECT_LT(Largest(*difference), 1e-2);
  EXPECT_NEAR(Eigen::AngleAxisd(difference->rotation).angle(), std::hypot(30.0, 20.0) / 2e5, 1e-7);
}

TEST(ProjectionDifference, WeightsSayWhereItFits) {
  const CameraModel a = CameraModel::Pinhole(1000, 800, 1000.0, 1000.0, 500.0, 400.0);
  const CameraModel b = CameraModel::Pinhole(1000, 800, 1040.0, 1000.0, 500.0, 400.0);
  const ImageGrid grid = GridOverImage(1000, 800, 21);
  std::vector<double> left(grid.pixels.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < left.size(); ++i)
    if (grid.pixels[i].x() < 100.0) left[i] = 1.0;
  const auto difference = ProjectionDifference(a, b, grid.pixels, left);
  ASSERT_TRUE(difference);
  EXPECT_LT(difference->px[21 * 8].norm(), 3.0);
  EXPECT_GT(difference->px[21 * 8 + 20].norm(), 20.0);
}

TEST(ProjectionDifference, RefusesWhatIsNotComparable) {
  const ImageGrid grid = GridOverImage(2000, 1400, 20);
  const std::vector<double> none(grid.pixels.size(), 0.0);
  const auto empty = ProjectionDifference(ExampleLens(), ExampleLens(), grid.pixels, none);
  ASSERT_FALSE(empty);
  EXPECT_THAT(empty.error().text, testing::HasSubstr("at 0 pixels, allowed are at least 3"));
  const auto sizes = ProjectionDifference(
      ExampleLens(), CameraModel::Pinhole(1000, 800, 900, 900, 500, 400), grid.pixels, none);
  ASSERT_FALSE(sizes);
  EXPECT_THAT(sizes.error().text, testing::HasSubstr("2000 x 1400 and 1000 x 800"));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::lens
