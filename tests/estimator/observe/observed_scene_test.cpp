// Proves: what is observed of a ball comes with a signature for each view and counts that fit the
// pixels; clipped, black and missing pictures are refused. Does not prove that what is accepted
// leads to an estimate.
#include "estimator/observe/observed_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/estimator/random_observations.h"
#include "tests/estimator/tiny_ball.h"

namespace turnlight::estimator::observe {
namespace {

using testing::HasSubstr;

TEST(ObserveScene, GivesPixelsCountsAndSignatures) {
  const TinyBall ball(TwoLights(), 3);
  const auto scene = ObserveScene(model::SourceOf(ball.keyframes), ball.geometry, ball.rays);
  ASSERT_TRUE(scene) << scene.error().text;
  EXPECT_EQ(scene->signatures.size(), 3u);
  EXPECT_EQ(scene->counts.saturated, 0u);
  EXPECT_GE(scene->counts.edge, scene->counts.on_target - scene->pixels.used);
  EXPECT_GT(scene->pixels.used, 1500u);
  EXPECT_EQ(scene->pixels.tile_begin.size(), 4u);
}

void ExpectRefusal(const TinyBall& ball, const char* words) {
  const auto scene = ObserveScene(model::SourceOf(ball.keyframes), ball.geometry, ball.rays);
  ASSERT_FALSE(scene) << words;
  EXPECT_EQ(scene.error().kind, ErrorKind::kNoEstimate);
  EXPECT_THAT(scene.error().text, HasSubstr(words));
}

TEST(ObserveScene, RefusesWhatShowsNothing) {
  const TinyBall good(TwoLights(), 1);
  TinyBall ball = {TwoLights(), 1};
  ball.keyframes[0].image.saturated.setTo(255);
  ExpectRefusal(ball, "lie above radiometry's saturation, at values that differ");
  ball.keyframes[0].image.radiance.setTo(cv::Scalar::all(1.0));
  ExpectRefusal(ball, "are clipped: lower the exposure");

  ball.keyframes = good.keyframes;
  ball.keyframes[0].image.radiance = cv::Mat3f(48, 64, cv::Vec3f::all(0.0f));
  ExpectRefusal(ball, "every usable pixel is black");

  ball.keyframes = good.keyframes;
  ball.keyframes[0].X_WT.translation = {0.0, 0.0, 100.0};
  ExpectRefusal(ball, "No pixel shows the target");
}

}  // namespace
}  // namespace turnlight::estimator::observe
