// Proves: clipped pixels are taken and marked as one-sided, highlights count pixel by pixel and the
// rest by area, whatever share of it is taken; nothing depends on the exposure.
#include "estimator/observe/photograph.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estimator/observe/observations.h"
#include "tests/estimator/photograph_ball.h"

namespace turnlight::estimator::observe {
namespace {

const PhotographBall& Ball() {
  static const PhotographBall kBall(GlossyScene({{0.9, 0.3, 0.3}, {0.7, -0.6, 0.3}}));
  return kBall;
}

Photograph Take(const PhotographBall& ball, const PhotographOptions& options = {}) {
  return *TakePhotograph(ball.source(), ball.geometry, ball.rays, options);
}

// The sum of what pixels count for, outside highlights or in them.
double Independent(const Observations& pixels, bool highlights) {
  double sum = 0.0;
  for (std::size_t i = 0; i < pixels.size(); ++i)
    if (pixels.pixel[i] != Observations::kNoPixel)
      sum += ((pixels.at_white[i] & kInHighlight) != 0) == highlights ? 1.0 : 0.0;
  return sum;
}

TEST(TakePhotograph, KeepsClippedPixelsAsThisOrMore) {
  const Photograph photograph = Take(Ball());
  const Observations& pixels = photograph.pixels;
  ASSERT_TRUE(pixels.one_sided);
  std::size_t clipped = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels.pixel[i] == Observations::kNoPixel) continue;
    const bool saturated = Ball().keyframes[0].image.saturated.data[pixels.pixel[i]] != 0;
    EXPECT_EQ((pixels.at_white[i] & 7) == 7, saturated);
    EXPECT_TRUE(!saturated || (pixels.at_white[i] & kInHighlight) != 0);
    clipped += saturated ? 1 : 0;
  }
  EXPECT_GT(clipped, 5u);
  EXPECT_EQ(photograph.spots.size(), 2u);
  // Elsewhere they are left out.
  const Observations usual = BuildObservations(Ball().keyframes, Ball().geometry, Ball().rays);
  for (const std::uint32_t pixel : usual.pixel)
    EXPECT_TRUE(pixel == Observations::kNoPixel ||
                Ball().keyframes[0].image.saturated.data[pixel] == 0);
}

TEST(TakePhotograph, CountsTheRestByArea) {
  PhotographOptions all;
  all.most_shaded = 1000000;
  const Photograph whole = Take(Ball(), all);
  const double bright = Independent(whole.pixels, true), shaded = Independent(whole.pixels, false);
  EXPECT_NEAR(whole.pixels.independent, bright + shaded / all.correlated, 1.0);
  PhotographOptions few = all;
  few.most_shaded = 800;
  const Photograph thinned = Take(Ball(), few);
  EXPECT_NEAR(Independent(thinned.pixels, false), 800.0, 100.0);
  EXPECT_EQ(Independent(thinned.pixels, true), bright);
  EXPECT_NEAR(thinned.pixels.independent, whole.pixels.independent, 1.0);
  // The sum of the squared weights is what they say together: the same but for chance.
  const auto information = [](const Observations& pixels) {
    double sum = 0.0;
    for (std::size_t i = 0; i < pixels.size(); ++i)
      if (pixels.pixel[i] != Observations::kNoPixel && (pixels.at_white[i] & kInHighlight) == 0)
        sum += std::pow(pixels.WeightOf(i), 2);
    return sum;
  };
  EXPECT_NEAR(information(thinned.pixels) / information(whole.pixels), 1.0, 0.15);
}

TEST(TakePhotograph, TakesSoManyPixelsOfHighlights) {
  const Photograph whole = Take(Ball());
  PhotographOptions few;
  few.most_bright = 200;
  const Photograph thinned = Take(Ball(), few);
  ASSERT_GT(Independent(whole.pixels, true), 400.0);
  EXPECT_NEAR(Independent(thinned.pixels, true), 200.0, 60.0);
  EXPECT_NEAR(whole.pixels.independent - thinned.pixels.independent,
              Independent(whole.pixels, true) - 200.0, 1.0);
}

TEST(TakePhotograph, WeighsByShares) {
  PhotographBall dark(GlossyScene({{0.9, 0.3, 0.3}, {0.7, -0.6, 0.3}}));
  for (model::Keyframe& keyframe : dark.keyframes) keyframe.image.radiance *= std::exp2(-12.0);
  const Photograph usual = Take(Ball()), same = Take(dark);
  EXPECT_EQ(same.pixels.radiance_unit, std::exp2(-12.0) * usual.pixels.radiance_unit);
  EXPECT_EQ(same.pixels.weight, usual.pixels.weight);
  EXPECT_EQ(same.pixels.radiance, usual.pixels.radiance);
}

}  // namespace
}  // namespace turnlight::estimator::observe
