// Proves: a residual map has the mean over the channels of observed minus model at each pixel of
// its own view, and no number where nothing was used. Does not prove the model (prediction_test).
#include "estimator/residual_maps.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estimator/solve/prediction.h"
#include "tests/estimator/random_observations.h"

namespace turnlight::estimator {
namespace {

TEST(ResidualMaps, HoldObservedMinusModel) {
  const model::Scene scene = TwoLights();
  observe::Observations all = RandomObservations(512, 3, 1, &scene).observations;
  // Two views of 256 pixels, every other pixel of 32 x 16; filling would be marked.
  all.tile_begin = {0, 1, 2};
  for (std::size_t i = 0; i < 512; ++i) all.pixel[i] = static_cast<std::uint32_t>(2 * (i % 256));
  const solve::Prediction model = solve::Predict(all, scene, {});
  for (std::size_t i = 0; i < 512; ++i)
    for (std::size_t c = 0; c < 3; ++c)
      all.radiance[c][i] =
          model[c][i] + 0.001f * static_cast<float>(i) + 0.01f * (static_cast<float>(c) - 1.0f);
  all.pixel[300] = observe::Observations::kNoPixel;
  solve::EvaluateOptions options;
  auto usable = std::make_shared<std::vector<std::uint8_t>>(all.size(), 1);
  (*usable)[7] = 0;
  options.shadows.usable = usable;
  EXPECT_TRUE(ResidualMaps(all, scene, options, {32, 16}, {}).empty());
  EXPECT_EQ(ResidualMaps(all, scene, options, {32, 16}, {1}).begin()->first, 1u);
  const auto maps = ResidualMaps(all, scene, options, {32, 16}, {0, 1});
  ASSERT_EQ(maps.size(), 2u);
  for (std::size_t i = 0; i < 512; ++i) {
    const cv::Mat1f& map = maps.at(i / 256);
    ASSERT_EQ(map.size(), cv::Size(32, 16));
    const int at = static_cast<int>(2 * (i % 256)), row = at / 32, column = at % 32;
    EXPECT_TRUE(std::isnan(map(row, column + 1))) << "between";
    if (i == 300 || i == 7) {
      EXPECT_TRUE(std::isnan(map(row, column))) << i;
    } else {
      EXPECT_NEAR(map(row, column), 0.001f * static_cast<float>(i), 1e-6f);
    }
  }
}

}  // namespace
}  // namespace turnlight::estimator
