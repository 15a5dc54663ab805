// Proves: a builder that may hold few pixels ends with whole blocks of the very pixels that one
// without a limit has, nearly as many as it may hold, the same for any number of threads; grey
// keyframes before a coloured one, and keyframes without noise, are taken as in one go. Does not
// prove how much memory that takes: large_pictures_test does.
#include "estimator/observe/observations_builder.h"

#include <gtest/gtest.h>

#include <map>
#include <utility>

#include "base/parallel.h"
#include "estimator/observe/observation_access.h"
#include "tests/estimator/random_observations.h"
#include "tests/estimator/tiny_ball.h"

namespace turnlight::estimator::observe {
namespace {

Observations Build(const std::vector<model::Keyframe>& keyframes, const target::Geometry& geometry,
                   const calib::RayGrid& rays, std::size_t most, std::size_t* usable = nullptr) {
  ObservationsBuilder builder(geometry, rays, keyframes.size(), most);
  EXPECT_TRUE(TraceKeyframes(model::SourceOf(keyframes), geometry, rays, nullptr,
                             [&](std::size_t, const model::Keyframe& keyframe,
                                 KeyframeTracer& tracer) { builder.Add(keyframe, tracer); }));
  if (usable != nullptr) *usable = builder.usable();
  return builder.Finish();
}

// By keyframe and pixel, where it is among the observations.
std::map<std::pair<std::size_t, std::uint32_t>, std::size_t> Places(const Observations& all) {
  std::map<std::pair<std::size_t, std::uint32_t>, std::size_t> out;
  for (std::size_t k = 0; k + 1 < all.tile_begin.size(); ++k)
    for (std::size_t i = all.tile_begin[k] * kTile; i < all.tile_begin[k + 1] * kTile; ++i)
      if (all.pixel[i] != Observations::kNoPixel) out[{k, all.pixel[i]}] = i;
  return out;
}

TEST(ObservationsBuilder, KeepsWholeBlocksOfWhatThereIs) {
  const TinyBall ball(TwoLights(), 8, 0.001);
  std::size_t usable = 0;
  const Observations whole = Build(ball.keyframes, ball.geometry, ball.rays, kAllPixels, &usable);
  EXPECT_EQ(whole.blocks.share, 1.0);
  EXPECT_GE(usable, whole.used);
  const std::size_t most = whole.used / 3;
  const Observations some = Build(ball.keyframes, ball.geometry, ball.rays, most);
  EXPECT_LE(some.used, most);
  EXPECT_GT(some.used, most / 2) << "blocks are large in so small pictures";
  const auto places = Places(whole), kept = Places(some);
  ASSERT_EQ(kept.size(), some.used);
  for (const auto& [at, in_whole] : places) {
    const auto& [keyframe, pixel] = at;
    const auto found = kept.find(at);
    ASSERT_EQ(found != kept.end(),
              some.blocks.Keeps(static_cast<std::uint32_t>(keyframe), static_cast<int>(pixel) % 64,
                                static_cast<int>(pixel) / 64));
    if (found == kept.end()) continue;
    const std::size_t i = found->second, j = in_whole;
    EXPECT_EQ(At(some.normal, i), At(whole.normal, j));
    EXPECT_EQ(At(some.step, 3, i), At(whole.step, 3, j));
    EXPECT_EQ(some.radiance[1][i], whole.radiance[1][j]);
    EXPECT_LT((some.reference + some.radius * At(some.position, i) - whole.reference -
               whole.radius * At(whole.position, j))
                  .norm(),
              1e-6);
  }
}

// Filling is as it always is, and the reference is the centroid of what is kept.
TEST(ObservationsBuilder, WhatIsGivenUpLeavesNoTrace) {
  const TinyBall ball(TwoLights(), 8, 0.001);
  const Observations some = Build(ball.keyframes, ball.geometry, ball.rays, 2000);
  ASSERT_EQ(some.tile_begin.size(), 9u);
  EXPECT_EQ(some.size(), some.tile_begin.back() * kTile);
  EXPECT_EQ(some.radiance[0].size(), some.size());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < some.size(); ++i) {
    sum += At(some.position, i);
    if (some.pixel[i] != Observations::kNoPixel) continue;
    EXPECT_EQ(At(some.normal, i), Eigen::Vector3d::UnitZ());
    EXPECT_EQ(At(some.mirrored, i), Eigen::Vector3d::UnitZ());
    EXPECT_EQ(At(some.position, i), Eigen::Vector3d::Zero());
    EXPECT_EQ(some.radiance[0][i], 0.0f);
  }
  EXPECT_LT((sum / static_cast<double>(some.used)).norm(), 1e-6);
}

TEST(ObservationsBuilder, SameBitsForAnyNumberOfThreads) {
  const TinyBall ball(TwoLights(), 8, 0.001);
  SetThreads(1);
  const Observations one = Build(ball.keyframes, ball.geometry, ball.rays, 2000);
  for (const int threads : {2, 7}) {
    SetThreads(threads);
    const Observations again = Build(ball.keyframes, ball.geometry, ball.rays, 2000);
    EXPECT_EQ(again.pixel, one.pixel);
    EXPECT_EQ(again.position, one.position);
    EXPECT_EQ(again.radiance, one.radiance);
    EXPECT_EQ(again.tile_footprint, one.tile_footprint);
  }
  SetThreads(0);
}

TEST(ObservationsBuilder, GreyKeyframesMayComeBeforeColouredOnes) {
  TinyBall ball(TwoLights(), 3);
  for (const int k : {0, 1}) {
    cv::Mat grey;
    cv::extractChannel(ball.keyframes[static_cast<std::size_t>(k)].image.radiance, grey, 0);
    if (k == 1) cv::merge(std::vector<cv::Mat>(3, grey), grey);
    ball.keyframes[static_cast<std::size_t>(k)].image.radiance = grey;
  }
  const Observations all = Build(ball.keyframes, ball.geometry, ball.rays, kAllPixels);
  EXPECT_EQ(all.channels, 3);
  const std::size_t coloured = all.tile_begin[2] * kTile;
  for (std::size_t i = 0; i < coloured; ++i)
    for (const std::size_t c : {1u, 2u}) ASSERT_EQ(all.radiance[c][i], all.radiance[0][i]);
  EXPECT_NE(all.radiance[2][coloured], all.radiance[0][coloured]);
  ball.keyframes.pop_back();
  EXPECT_EQ(Build(ball.keyframes, ball.geometry, ball.rays, kAllPixels).channels, 1);
}

TEST(ObservationsBuilder, OneKeyframeWithoutNoiseLeavesAllUnweighted) {
  TinyBall ball(TwoLights(), 2);
  for (model::Keyframe& keyframe : ball.keyframes)
    keyframe.image.variance = cv::Mat1f(48, 64, 1e-6f);
  EXPECT_FALSE(Build(ball.keyframes, ball.geometry, ball.rays, kAllPixels).weight.empty());
  ball.keyframes[1].image.variance = cv::Mat1f();
  const Observations all = Build(ball.keyframes, ball.geometry, ball.rays, kAllPixels);
  EXPECT_TRUE(all.weight.empty());
  EXPECT_TRUE(all.variance.empty());
}

}  // namespace
}  // namespace turnlight::estimator::observe
