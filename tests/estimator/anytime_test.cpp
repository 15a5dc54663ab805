// Proves: there is an estimate from the first keyframe that shows the target on, it gets better
// with each that comes, it stays when a step fails, a keyframe that does not belong to the others
// is left out, and the same calls give the same bits. Does not prove how soon it is good:
// docs/capture.md has that, measured.
#include "estimator/anytime.h"

#include <gtest/gtest.h>

#include "tests/estimator/random_observations.h"
#include "tests/estimator/tiny_ball.h"

namespace turnlight::estimator {
namespace {

TEST(AnytimeEstimator, IsThereFromTheFirstKeyframeAndGetsBetter) {
  const model::Scene truth = TwoLights();
  const TinyBall ball(truth, 4, 0.003);
  AnytimeEstimator estimator(ball.geometry, ball.rays, ball.camera);
  EXPECT_FALSE(estimator.Current().has_value());
  std::vector<double> sigmas;
  for (const model::Keyframe& keyframe : ball.keyframes) {
    estimator.Add(keyframe);
    ASSERT_TRUE(estimator.Step());
    ASSERT_TRUE(estimator.Current().has_value());
    EXPECT_EQ(estimator.Current()->views, static_cast<int>(estimator.keyframes()));
    ASSERT_EQ(estimator.Current()->lights.size(), 2u) << estimator.keyframes();
    sigmas.push_back(estimator.Current()->stat.lights[0].direction);
  }
  EXPECT_EQ(estimator.keyframes(), 4u);
  EXPECT_LT(sigmas.back(), 0.8 * sigmas.front());
  EXPECT_LT(WorstDirectionDeg(estimator.Current()->ToScene().lights, truth.lights), 0.5);

  AnytimeEstimator again(ball.geometry, ball.rays, ball.camera);
  for (const model::Keyframe& keyframe : ball.keyframes) {
    again.Add(keyframe);
    ASSERT_TRUE(again.Step());
  }
  EXPECT_EQ(again.Current()->rms, estimator.Current()->rms);
  EXPECT_EQ(again.Current()->lights[1].light.direction,
            estimator.Current()->lights[1].light.direction);
}

TEST(AnytimeEstimator, NothingUsableIsNoEstimateYet) {
  TinyBall ball(TwoLights(), 2, 0.003);
  ball.keyframes[0].mask.setTo(0);
  AnytimeEstimator estimator(ball.geometry, ball.rays, ball.camera);
  estimator.Add(ball.keyframes[0]);
  const Status status = estimator.Step();
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::kNoEstimate);
  EXPECT_FALSE(estimator.Current().has_value());
  estimator.Add(ball.keyframes[1]);
  EXPECT_TRUE(estimator.Step());
  EXPECT_TRUE(estimator.Current().has_value());
}

TEST(AnytimeEstimator, LeavesOutAKeyframeThatDoesNotBelongToTheOthers) {
  const model::Scene truth = TwoLights();
  TinyBall ball(truth, 6, 0.003);
  ball.keyframes[3].image.radiance.setTo(0.0f);
  AnytimeEstimator estimator(ball.geometry, ball.rays, ball.camera);
  for (const model::Keyframe& keyframe : ball.keyframes) estimator.Add(keyframe);
  const Status status = estimator.Step();
  ASSERT_TRUE(status) << status.error().text;
  ASSERT_EQ(estimator.OddKeyframes().size(), 1u);
  EXPECT_EQ(estimator.OddKeyframes().begin()->first, 3u);
  EXPECT_EQ(estimator.OddKeyframes().begin()->second, "is black");
  EXPECT_EQ(estimator.Current()->views, 5);
  EXPECT_LT(WorstDirectionDeg(estimator.Current()->ToScene().lights, truth.lights), 0.5);
}

// Lamps that are off in most pictures: those with light are the odd ones, and without them there is
// no estimate. Pictures beside the target make it a step from the last estimate on.
TEST(AnytimeEstimator, KeepsTheFirstEstimateIfThereIsNoneWithoutOddKeyframes) {
  const TinyBall ball(TwoLights(), 10, 0.003);
  AnytimeEstimator estimator(ball.geometry, ball.rays, ball.camera);
  estimator.Add(ball.keyframes[0]);
  model::Keyframe beside = ball.keyframes[0];
  beside.X_WC.rotation = beside.X_WC.rotation * Eigen::Vector3d(-1, 1, -1).asDiagonal();
  for (int k = 0; k < 17; ++k) estimator.Add(beside);
  ASSERT_TRUE(estimator.Step());
  AnytimeEstimator rest(ball.geometry, ball.rays, ball.camera);
  for (std::size_t k = 0; k < 16; ++k) {
    model::Keyframe black = ball.keyframes[k % 10];
    black.image.radiance = black.image.radiance.clone();
    black.image.radiance.setTo(0.0);
    estimator.Add(black);
    rest.Add(black);
  }
  EXPECT_FALSE(rest.Step());
  estimator.Add(ball.keyframes[0]);
  const Status status = estimator.Step();
  ASSERT_TRUE(status) << status.error().text;
  EXPECT_TRUE(estimator.OddKeyframes().empty());
  EXPECT_EQ(estimator.Current()->views, 35);
}

}  // namespace
}  // namespace turnlight::estimator
