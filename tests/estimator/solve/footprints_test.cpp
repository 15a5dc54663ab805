// Proves: the finer the lobe and the larger the footprint, the more samples, up to the kernel's
// most and no fewer than asked for; and with as many the mean of a Gaussian lobe over the footprint
// is right to 1e-4 of its peak where the most is not reached. Does not prove it of lobes cut off at
// a terminator.
#include "estimator/solve/footprints.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estimator/solve/kernel/tile_kernel.h"
#include "estimator/solve/kernel_scene.h"
#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::solve {
namespace {

observe::Observations TilesWithFootprints(const std::vector<float>& footprints) {
  observe::Observations out;
  out.tile_footprint = footprints;
  out.pixel.resize(footprints.size() * observe::kTile);
  return out;
}

model::Reflectance OfShininess(double shininess) {
  model::Reflectance reflectance;
  reflectance.lobes[0].shape = shininess;
  return reflectance;
}

TEST(FootprintSamples, AreForTheNarrowestLobe) {
  const observe::Observations tiles = TilesWithFootprints({0.0f, 0.02f, 0.2f});
  model::Reflectance both = OfShininess(5.0);
  both.lobes[1] = {model::SpecularModel::kGgx, 0.1, 0.02};
  model::Reflectance narrow = both;
  std::swap(narrow.lobes[0], narrow.lobes[1]);
  EXPECT_EQ(FootprintSamples(tiles, both), FootprintSamples(tiles, narrow));
  EXPECT_NE(FootprintSamples(tiles, both), FootprintSamples(tiles, OfShininess(5.0)));
}

TEST(FootprintSamples, GrowWithFootprintAndShininess) {
  std::vector<float> footprints;
  for (int i = 0; i < 60; ++i) footprints.push_back(0.01f * static_cast<float>(i));
  const observe::Observations tiles = TilesWithFootprints(footprints);
  std::vector<std::uint8_t> wider(footprints.size(), 1);
  for (const double shininess : {1.0, 10.0, 100.0, 1000.0, 1e5}) {
    const auto samples = FootprintSamples(tiles, OfShininess(shininess));
    ASSERT_EQ(samples.size(), footprints.size());
    EXPECT_EQ(samples[0], 1);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      EXPECT_GE(samples[i], wider[i]) << shininess;
      EXPECT_LE(samples[i], kernel::kMaxSamples);
      if (i > 0) {
        EXPECT_GE(samples[i], samples[i - 1]);
      }
    }
    wider = samples;
  }
  EXPECT_EQ(wider.back(), kernel::kMaxSamples);
}

TEST(FootprintSamples, AreNoFewerThanAskedFor) {
  const auto samples =
      FootprintSamples(TilesWithFootprints({0.0f, 0.03f, 0.2f}), OfShininess(10.0), 2);
  EXPECT_EQ(samples[0], 2);
  EXPECT_EQ(samples[1], 2);
  EXPECT_GE(samples[2], 2);
}

TEST(FootprintSamples, AreEnoughForAGaussianLobe) {
  const RandomObservations random(10, 1, 1);
  EvaluateOptions options;
  options.aperture = 1.0;
  const KernelScene scene(random.observations, TwoLights(), options);
  constexpr double kHalfWidth = 0.1;
  // The lobe whose half-width is that.
  const double shininess = -1.0 / std::log2(std::cos(kHalfWidth));
  for (const double ratio : {0.1, 0.19, 0.3, 0.49, 0.6, 1.0, 1.2, 2.0, 3.0, 5.0}) {
    const int n = FootprintSamples(TilesWithFootprints({static_cast<float>(ratio * kHalfWidth)}),
                                   OfShininess(shininess), 2)[0];
    for (const double offset : {0.0, 0.3, 1.0}) {
      double mean = 0.0, truth = 0.0;
      const auto lobe = [&](double at) {
        return std::exp2(
            -std::pow((offset * kHalfWidth + at * ratio * kHalfWidth) / kHalfWidth, 2));
      };
      for (int i = 0; i < n; ++i) mean += scene.model.weight[n][i] * lobe(scene.model.node[n][i]);
      for (int i = 0; i < 2000; ++i) truth += lobe((i + 0.5) / 2000.0 - 0.5) / 2000.0;
      EXPECT_NEAR(mean, truth, 1.5e-4) << ratio << " half-widths, " << n << " samples";
    }
  }
}

}  // namespace
}  // namespace turnlight::estimator::solve
