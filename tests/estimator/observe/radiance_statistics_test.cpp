// Proves: white noise on shading is found with its size, and neither a slope nor the jump from one
// row to the next is taken for it; medians and quantiles are those of the pixels that are there.
// Does not prove anything of textured pictures, for which the noise is an upper bound.
#include "estimator/observe/radiance_statistics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::observe {
namespace {

// A parabola along rows of so many pixels; every row of another brightness.
Observations ShadedRows(std::size_t count, int channels, std::size_t row_length) {
  Observations all = RandomObservations(count, channels, 1).observations;
  const RandomStream random(2, 2);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t row = i / row_length, column = i % row_length;
    all.pixel[i] = static_cast<std::uint32_t>(row * (row_length + 10) + column);
    const double along = static_cast<double>(column) / static_cast<double>(row_length);
    for (int c = 0; c < channels; ++c)
      all.radiance[c][i] = static_cast<float>(random.Uniform(row) + 0.3 * along -
                                              (row_length > 10 ? 0.2 : 0.0) * along * along);
  }
  return all;
}

TEST(EstimateNoise, IsThatOfWhiteNoiseOnShading) {
  for (const int channels : {1, 3})
    for (const double sigma : {0.001, 0.02}) {
      Observations all = ShadedRows(20000, channels, 100);
      AddNoise(sigma, 3, all);
      EXPECT_NEAR(EstimateNoise(all), sigma, 0.03 * sigma);
    }
}

TEST(EstimateNoise, ShadingAloneIsHardlyAny) {
  // The parabola's second difference is 4e-5 of white.
  EXPECT_LT(EstimateNoise(ShadedRows(20000, 3, 100)), 3e-5);
  EXPECT_EQ(EstimateNoise(RandomObservations(1, 3, 1).observations), 0.0);
}

// Rows of three: two of three differences would run over a jump.
TEST(EstimateNoise, NothingIsTakenAcrossAGap) {
  Observations all = ShadedRows(9000, 1, 3);
  AddNoise(0.01, 3, all);
  EXPECT_NEAR(EstimateNoise(all), 0.01, 0.0006);
}

TEST(RadianceStatistics, MedianAndQuantilesOfThePixelsThatAreThere) {
  Observations all = RandomObservations(1001, 3, 1).observations;
  for (std::size_t i = 0; i < all.used; ++i) {
    all.radiance[0][i] = static_cast<float>((i * 37) % 1001);  // 0 to 1000, out of order
    all.radiance[1][i] = 2.0f * all.radiance[0][i];
    all.radiance[2][i] = -all.radiance[0][i];
  }
  for (std::size_t i = all.used; i < all.size(); ++i)
    for (int c = 0; c < 3; ++c) all.radiance[c][i] = 1e6f;  // filling
  EXPECT_EQ(MedianColour(all), Eigen::Vector3d(500.0, 1000.0, -500.0));
  EXPECT_EQ(DarkRadiance(all, 0), 50.0);
  EXPECT_EQ(DarkRadiance(all, 1), 100.0);
  EXPECT_EQ(BrightestRadiance(all), 999.0);
}

TEST(RadianceStatistics, GreyIsTheSameInAllColours) {
  Observations all = RandomObservations(101, 1, 1).observations;
  for (std::size_t i = 0; i < all.used; ++i) all.radiance[0][i] = static_cast<float>(i);
  EXPECT_EQ(MedianColour(all), Eigen::Vector3d::Constant(50.0));
}

}  // namespace
}  // namespace turnlight::estimator::observe
