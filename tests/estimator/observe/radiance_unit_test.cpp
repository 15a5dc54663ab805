// Proves: the unit is a power of two that brings any brightness to about 1 and leaves alone what
// was exposed well and what was not lit; dark and bright pictures have the arrays of well-exposed
// ones in another unit, whether built at once or joined from parts, with the same weights. Does not
// prove that an estimate is then the same (tests/estimator/radiance_unit_test.cpp).
#include "estimator/observe/radiance_unit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estimator/observe/sampling.h"
#include "tests/estimator/random_observations.h"
#include "tests/estimator/tiny_ball.h"

namespace turnlight::estimator::observe {
namespace {

TEST(RadianceUnit, BringsAnyBrightnessToAboutOne) {
  for (double brightest = 1e-6; brightest < 1e6; brightest *= 1.7) {
    const double unit = RadianceUnit(brightest);
    EXPECT_EQ(std::exp2(std::round(std::log2(unit))), unit) << "exact in every float";
    if (brightest > 0.02 && brightest < 50.0) {
      EXPECT_EQ(unit, 1.0);
    } else {
      EXPECT_LE(std::abs(std::log2(brightest / unit)), 0.5 + 1e-12);
    }
  }
  for (const double unlit : {0.0, 1e-8, -3.0}) EXPECT_EQ(RadianceUnit(unlit), 1.0);
}

TEST(RadianceUnit, DividesRadiancesAndNothingElse) {
  Observations all = RandomObservations(300, 3, 1).observations;
  for (auto& channel : all.radiance)
    for (float& value : channel) value *= 1024.0f;
  GiveWeights(1, all);
  const Observations before = all;
  SetRadianceUnit(all);
  EXPECT_EQ(all.radiance_unit, 1024.0);
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_EQ(all.radiance[c][i] * 1024.0f, before.radiance[c][i]);
    EXPECT_EQ(all.variance[i] * 1024.0f * 1024.0f, before.variance[i]);
  }
  EXPECT_EQ(all.position, before.position);
  EXPECT_EQ(all.weight, before.weight);
  EXPECT_EQ(Subsample(all, 100, 1).radiance_unit, 1024.0);
}

// A ball whose brightest radiance is about `factor`, with the sensor's noise known.
TinyBall BallOfLevel(double factor) {
  TinyBall ball(TwoLights(), 3, 0.003);
  for (model::Keyframe& keyframe : ball.keyframes) {
    keyframe.image.variance = cv::Mat1f(ball.rays.height(), ball.rays.width());
    for (int i = 0; i < static_cast<int>(keyframe.image.variance.total()); ++i)
      keyframe.image.variance(i / ball.rays.width(), i % ball.rays.width()) =
          static_cast<float>(factor * factor * (9e-6 + 1e-9 * i));
    keyframe.image.radiance *= 2.0 * factor;
  }
  return ball;
}

TEST(RadianceUnit, PicturesOfAnyLevelHaveTheSameArrays) {
  const TinyBall usual = BallOfLevel(1.0);
  const Observations expected = BuildObservations(usual.keyframes, usual.geometry, usual.rays);
  ASSERT_EQ(expected.radiance_unit, 1.0);
  for (const double factor : {std::exp2(-12.0), std::exp2(12.0)}) {
    const TinyBall ball = BallOfLevel(factor);
    std::vector<Observations> parts;
    for (const model::Keyframe& keyframe : ball.keyframes) {
      parts.push_back(BuildPart(keyframe, ball.geometry, ball.rays));
      EXPECT_EQ(parts.back().radiance_unit, 1.0) << "the unit is that of all parts";
    }
    for (const Observations& all :
         {BuildObservations(ball.keyframes, ball.geometry, ball.rays), Concatenate(parts)}) {
      EXPECT_EQ(all.radiance_unit, factor);
      EXPECT_EQ(all.radiance, expected.radiance);
      EXPECT_EQ(all.variance, expected.variance);
      EXPECT_EQ(all.weight, expected.weight);
      EXPECT_EQ(all.pixel, expected.pixel);
    }
  }
}

}  // namespace
}  // namespace turnlight::estimator::observe
