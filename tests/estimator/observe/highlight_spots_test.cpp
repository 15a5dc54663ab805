// Proves: clipped highlights of several lights are found, where the mirrored view says, and none on
// a matte ball; spots of one light in several views are one. Does not prove that real dirt is told
// from highlights: that takes a fit (start/photograph_lights_test).
#include "estimator/observe/highlight_spots.h"

#include <gtest/gtest.h>

#include "tests/estimator/photograph_ball.h"

namespace turnlight::estimator::observe {
namespace {

const std::vector<Eigen::Vector3d> kThree{{0.9, 0.3, 0.3}, {0.7, -0.6, 0.3}, {0.5, 0.2, -0.8}};

std::vector<Spot> SpotsOf(const PhotographBall& ball, std::size_t view = 0) {
  const cv::Mat1b inside(ball.rays.height(), ball.rays.width(), std::uint8_t{255});
  // The ball alone, two pixels within its outline.
  cv::Mat1b disc = cv::Mat1b::zeros(inside.size());
  for (int y = 0; y < disc.rows; ++y)
    for (int x = 0; x < disc.cols; ++x)
      if (std::hypot(x - 63.5, y - 55.5) < 46.0) disc(y, x) = 255;
  return FindSpots(ball.keyframes[view], view, disc, ball.geometry, ball.rays);
}

TEST(FindSpots, AreWhereLightsShowInTheMirror) {
  const PhotographBall ball(GlossyScene(kThree));
  ASSERT_GT(cv::countNonZero(ball.keyframes[0].image.saturated), 5) << "clipped";
  const std::vector<Spot> spots = SpotsOf(ball);
  ASSERT_EQ(spots.size(), 3u);
  for (const Spot& spot : spots) {
    EXPECT_LT(NearestDeg(spot.direction, kThree), 0.6) << "a pixel is 2.4 degrees";
    EXPECT_GT(spot.contrast, 0.12);
    EXPECT_GT(spot.sigmas, 4.0);
  }
  for (std::size_t i = 1; i < spots.size(); ++i) EXPECT_GE(spots[i - 1].sigmas, spots[i].sigmas);
}

TEST(FindSpots, AreNoneOnAMatteBall) {
  model::Scene matte = GlossyScene({kThree[0], kThree[1]});
  model::SetLobeModel(matte.reflectance, model::SpecularModel::kNone);
  EXPECT_TRUE(SpotsOf(PhotographBall(matte)).empty());
}

TEST(FindSpots, DoNotDependOnTheExposure) {
  PhotographBall ball(GlossyScene({kThree[0]}));
  const std::vector<Spot> usual = SpotsOf(ball);
  ball.keyframes[0].image.radiance *= 1.0 / 256.0;
  const std::vector<Spot> dark = SpotsOf(ball);
  ASSERT_EQ(dark.size(), usual.size());
  for (std::size_t i = 0; i < dark.size(); ++i)
    EXPECT_LT((dark[i].direction - usual[i].direction).norm(), 1e-6);
}

TEST(ClusterSpots, OfOneLightInSeveralViewsAreOne) {
  const PhotographBall ball(GlossyScene({kThree[0], kThree[1]}), 12);
  std::vector<Spot> all;
  for (std::size_t view = 0; view < ball.keyframes.size(); ++view)
    for (const Spot& spot : SpotsOf(ball, view)) all.push_back(spot);
  const std::vector<SpotCluster> clusters = ClusterSpots(all, Eigen::Vector3d::Zero(), 1.0);
  ASSERT_GE(clusters.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_LT(NearestDeg(clusters[i].direction, {kThree[0], kThree[1]}), 0.5);
    EXPECT_GE(clusters[i].views, 4u);
  }
}

TEST(GreyOf, IsTheMeanOfTheChannels) {
  cv::Mat3f colour(1, 2, cv::Vec3f(0.1f, 0.2f, 0.6f));
  colour(0, 1) = {0.0f, std::numeric_limits<float>::infinity(), 0.0f};
  const cv::Mat1f grey = GreyOf(colour);
  EXPECT_NEAR(grey(0, 0), 0.3f, 1e-6f);
  EXPECT_EQ(grey(0, 1), 0.0f);
}

}  // namespace
}  // namespace turnlight::estimator::observe
