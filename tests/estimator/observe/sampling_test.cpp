// Proves: a sample has about as many pixels as were asked for, the same for the same seed, in
// order, each with all that was known of it; an even one takes all alike, the other takes a pixel
// with the weight that its gradient along the row gives it. Does not prove that such samples lead
// to better starts: bench/studies does.
#include "estimator/observe/sampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::observe {
namespace {

constexpr std::size_t kSampledFrom = 40000, kSampleWanted = 4000;

// The first half is dark, the second a saw with the same gradient everywhere but for its turns.
Observations HalfFlatHalfSteep() {
  Observations all = RandomObservations(kSampledFrom, 1, 1).observations;
  for (std::size_t i = 0; i < kSampledFrom; ++i)
    all.radiance[0][i] = i < kSampledFrom / 2
                             ? 0.0f
                             : 1.0f - std::abs(static_cast<float>(i % 2000) / 1000.0f - 1.0f);
  return all;
}

// How many came from the first half; of about `expected`, five standard deviations are allowed.
void ExpectFromFirstHalf(const Observations& sample, double expected) {
  const auto first = std::count_if(sample.pixel.begin(),
                                   sample.pixel.begin() + static_cast<std::ptrdiff_t>(sample.used),
                                   [](std::uint32_t pixel) { return pixel < kSampledFrom / 2; });
  EXPECT_NEAR(static_cast<double>(first), expected, 5.0 * std::sqrt(expected));
}

TEST(Sampling, EvenTakesAllAlikeAndTheOtherByGradient) {
  const Observations all = HalfFlatHalfSteep();
  const Observations even = EvenSubsample(all, kSampleWanted, 7, nullptr);
  EXPECT_NEAR(static_cast<double>(even.used), kSampleWanted, 5.0 * std::sqrt(kSampleWanted));
  ExpectFromFirstHalf(even, kSampleWanted / 2.0);
  // Half of the pixels have twice the mean gradient: weights of 0.5 and 1.5.
  const Observations by_gradient = Subsample(all, kSampleWanted, 7);
  EXPECT_NEAR(static_cast<double>(by_gradient.used), kSampleWanted, 5.0 * std::sqrt(kSampleWanted));
  ExpectFromFirstHalf(by_gradient, kSampleWanted / 4.0);
}

TEST(Sampling, ByKeyframeHasTheSamePixelsInTilesOfTheirKeyframe) {
  Observations all = HalfFlatHalfSteep();
  all.tile_begin = {0, 40, 40, all.tiles()};  // one keyframe sees nothing
  const Observations plain = EvenSubsample(all, kSampleWanted, 7, nullptr);
  const PixelSample sample = SampleOfKeyframes(all, kSampleWanted, 7, nullptr, true);
  const Observations& by_keyframe = sample.pixels;
  ASSERT_EQ(by_keyframe.tile_begin.size(), all.tile_begin.size());
  EXPECT_EQ(by_keyframe.used, plain.used);
  EXPECT_EQ(by_keyframe.tile_begin[1], by_keyframe.tile_begin[2]);
  std::vector<std::uint32_t> pixels;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = by_keyframe.tile_begin[k] * kTile;
         i < by_keyframe.tile_begin[k + 1] * kTile; ++i) {
      if (by_keyframe.pixel[i] == Observations::kNoPixel) continue;
      EXPECT_EQ(by_keyframe.pixel[i] < 40 * kTile, k == 0);
      EXPECT_EQ(sample.keyframe[i], k);
      EXPECT_EQ(by_keyframe.radiance[0][i], all.radiance[0][by_keyframe.pixel[i]]);
      pixels.push_back(by_keyframe.pixel[i]);
    }
  EXPECT_TRUE(std::equal(pixels.begin(), pixels.end(), plain.pixel.begin()));
}

TEST(Sampling, IsAFunctionOfTheSeed) {
  const Observations all = HalfFlatHalfSteep();
  EXPECT_EQ(Subsample(all, kSampleWanted, 7).pixel, Subsample(all, kSampleWanted, 7).pixel);
  EXPECT_NE(Subsample(all, kSampleWanted, 7).pixel, Subsample(all, kSampleWanted, 8).pixel);
  EXPECT_EQ(EvenSubsample(all, kSampleWanted, 7, nullptr).pixel,
            EvenSubsample(all, kSampleWanted, 7, nullptr).pixel);
  EXPECT_EQ(EvenSubsample(all, kSampledFrom, 7, nullptr).used, kSampledFrom);
}

TEST(Sampling, NothingUnusableIsTaken) {
  const Observations all = HalfFlatHalfSteep();
  std::vector<std::uint8_t> usable(all.size(), std::uint8_t{1});
  for (std::size_t i = 0; i < kSampledFrom; i += 2) usable[i] = 0;
  const Observations sample = EvenSubsample(all, kSampleWanted, 7, &usable);
  EXPECT_NEAR(static_cast<double>(sample.used), kSampleWanted, 5.0 * std::sqrt(kSampleWanted));
  for (std::size_t i = 0; i < sample.used; ++i) EXPECT_EQ(sample.pixel[i] % 2, 1u);
}

TEST(Sampling, APixelKeepsAllThatIsKnownOfIt) {
  Observations all = RandomObservations(3000, 3, 1).observations;
  all.reference = {1.0, 2.0, 3.0};
  all.radius = 4.0;
  all.radiance_unit = 8.0;
  all.width = 50;
  GiveWeights(1, all);
  for (std::size_t k = 0; k < 6; ++k)
    for (std::size_t i = 0; i < all.size(); ++i) {
      all.footprint[k][i] = static_cast<BFloat16>(i + k);
      all.step[k][i] = static_cast<BFloat16>(2 * i + k);
    }
  for (std::size_t tile = 0; tile < all.tiles(); ++tile)
    all.tile_footprint[tile] = static_cast<float>(tile + 1);
  const Observations sample = EvenSubsample(all, 700, 5, nullptr);
  EXPECT_EQ(sample.reference, all.reference);
  EXPECT_EQ(sample.radius, all.radius);
  EXPECT_EQ(sample.radiance_unit, all.radiance_unit);
  EXPECT_EQ(sample.width, all.width);
  EXPECT_TRUE(sample.subsampled);
  ASSERT_EQ(sample.size() % kTile, 0u);
  EXPECT_EQ(sample.tile_begin, (std::vector<std::size_t>{0, sample.tiles()}));
  for (std::size_t i = 0; i < sample.used; ++i) {
    const std::size_t from = sample.pixel[i];
    if (i > 0) {
      EXPECT_GT(from, sample.pixel[i - 1]);
    }
    ForEachPlane([&](auto, const auto& of_all,
                     const auto& of_sample) { EXPECT_EQ(of_sample[i], of_all[from]); },
                 all, sample);
    EXPECT_GE(sample.tile_footprint[i / kTile], all.tile_footprint[from / kTile]);
  }
  for (std::size_t i = sample.used; i < sample.size(); ++i)
    EXPECT_EQ(sample.pixel[i], Observations::kNoPixel);
}

}  // namespace
}  // namespace turnlight::estimator::observe
