// Proves: the stored geometry is the mean over each pixel, by pictures whose pixels are means over
// 25 rays; why a pixel is left out; parts built alone are the whole; samples have the size that was
// asked for. Does not prove the same of meshes: their normals bend from face to face.
#include "estimator/observe/observations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "estimator/observe/observation_access.h"
#include "estimator/observe/sampling.h"
#include "estimator/solve/coordinates.h"
#include "estimator/solve/normal_equations.h"
#include "estimator/solve/prediction.h"
#include "estimator/solve/shadows.h"
#include "tests/estimator/small_scene.h"

namespace turnlight::estimator::observe {
namespace {

constexpr double kAwayFromEdges = 2.0;  // half footprints

// Float pictures without noise, of a matte ball.
rig::sim::SyntheticConfig FloatPictures(int frames) {
  rig::sim::SyntheticConfig config = TwoLightBall(1, 0.0, 0.05);
  config.motion.frames = frames;
  config.sensor = {};
  config.sensor.depth = rig::sim::SensorDepth::kFloat;
  auto& reflectance = std::get<model::Reflectance>(config.reflectance);
  reflectance.lobes[0].strength = 0.0;
  reflectance.lobes[0].model = model::SpecularModel::kNone;
  return config;
}

struct Built {
  rig::sim::SyntheticSession session;
  std::vector<model::Keyframe> keyframes;
  target::Geometry geometry;
  calib::RayGrid rays;

  explicit Built(const rig::sim::SyntheticConfig& config)
      : session(rig::sim::SynthesizeInMemory(config).value()),
        keyframes(rig::sim::ToKeyframes(session)),
        geometry(session.target),
        rays(session.camera) {}
};

TEST(Observations, ShadingOfABallIsItsMeanOverThePixel) {
  const Built built(FloatPictures(1));
  const Observations all = BuildObservations(built.keyframes, built.geometry, built.rays);
  const model::Scene truth = solve::ToSolver(built.session.scene, all);
  solve::EvaluateOptions options;
  options.shadows.usable = solve::AwayFromTerminators(all, truth.lights, kAwayFromEdges);
  const solve::Prediction model = solve::Predict(all, truth, options);
  double worst = 0.0, slanted = 0.0;
  int at_the_limb = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all.pixel[i] == Observations::kNoPixel || (*options.shadows.usable)[i] == 0) continue;
    const double off = std::abs(static_cast<double>(model[1][i] - all.radiance[1][i]));
    worst = std::max(worst, off);
    if (At(all.normal, i).dot(At(all.mirrored, i)) > 0.5) continue;
    slanted += static_cast<double>(model[1][i] - all.radiance[1][i]);
    ++at_the_limb;
  }
  ASSERT_GT(at_the_limb, 200);
  EXPECT_LT(worst, 5e-5);  // of 0.2: what a near light's falloff does within a pixel
  EXPECT_LT(std::abs(slanted / at_the_limb), 1.2e-5);
}

TEST(Observations, WhyAPixelIsLeftOut) {
  Built built(FloatPictures(1));
  model::Keyframe& keyframe = built.keyframes[0];
  const int row = keyframe.mask.rows / 2, column = keyframe.mask.cols / 2;
  keyframe.image.saturated(row, column) = 255;
  std::vector<cv::Mat1b> flags;
  const Observations all = BuildObservations(built.keyframes, built.geometry, built.rays, &flags);
  ASSERT_EQ(flags.size(), 1u);
  EXPECT_EQ(flags[0](0, 0), kOffTarget);
  for (int r = -2; r <= 2; ++r)
    for (int c = -2; c <= 2; ++c)
      EXPECT_EQ(flags[0](row + r, column + c) & kSaturated,
                std::max(std::abs(r), std::abs(c)) <= 1 ? kSaturated : 0);
  EXPECT_EQ(all.used, static_cast<std::size_t>(flags[0].total()) -
                          static_cast<std::size_t>(cv::countNonZero(flags[0])));
  double flattest = 1.0;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.pixel[i] != Observations::kNoPixel) {
      EXPECT_EQ(flags[0](static_cast<int>(all.pixel[i]) / flags[0].cols,
                         static_cast<int>(all.pixel[i]) % flags[0].cols),
                0);
      flattest = std::min(flattest, At(all.normal, i).dot(At(all.mirrored, i)));
    }
  EXPECT_GT(flattest, 0.24);
  EXPECT_LT(flattest, 0.4);
}

TEST(Observations, PartsBuiltAloneAreTheWhole) {
  const Built built(FloatPictures(3));
  const Observations whole = BuildObservations(built.keyframes, built.geometry, built.rays);
  std::vector<Observations> parts;
  for (const model::Keyframe& keyframe : built.keyframes)
    parts.push_back(BuildPart(keyframe, built.geometry, built.rays));
  const Observations joined = Concatenate(parts);
  EXPECT_EQ(joined.used, whole.used);
  EXPECT_EQ(joined.channels, whole.channels);
  EXPECT_EQ(joined.tile_begin, whole.tile_begin);
  EXPECT_EQ(joined.pixel, whole.pixel);
  EXPECT_EQ(joined.normal, whole.normal);
  EXPECT_EQ(joined.footprint, whole.footprint);
  EXPECT_EQ(joined.step, whole.step);
  EXPECT_EQ(joined.radiance, whole.radiance);
  EXPECT_EQ(joined.tile_footprint, whole.tile_footprint);
  EXPECT_LT((joined.reference - whole.reference).norm(), 1e-9 * whole.radius);
  double worst = 0.0;
  for (std::size_t i = 0; i < whole.size(); ++i)
    if (whole.pixel[i] != Observations::kNoPixel)
      worst = std::max(worst, (At(joined.position, i) - At(whole.position, i)).norm());
  EXPECT_LT(worst, 1e-6);
}

// A clipped pixel, and its neighbours: filling until they are taken, and then what they
// would have been without clipping. Parts remember them.
TEST(Observations, WhatWasHeldBackIsThereWhenItIsTaken) {
  Built built(FloatPictures(2));
  const Observations plain = BuildObservations(built.keyframes, built.geometry, built.rays);
  const cv::Mat1b& mask = built.keyframes[1].mask;
  built.keyframes[1].image.saturated(mask.rows / 2, mask.cols / 2) = 255;
  const Observations before = BuildObservations(built.keyframes, built.geometry, built.rays);
  ASSERT_EQ(before.held_back.size(), 9u);
  EXPECT_EQ(before.used + 9, plain.used);
  Observations all = before;
  TakeHeldBack(all);
  EXPECT_EQ(all.pixel, plain.pixel);
  EXPECT_EQ(all.normal, plain.normal);
  EXPECT_EQ(all.used, plain.used);
  int at_white = 0;
  for (const HeldBack& held : all.held_back) {
    const auto place = [&](const Observations& of) {
      return Eigen::Vector3d(of.reference + of.radius * At(of.position, held.at));
    };
    EXPECT_LT((place(all) - place(plain)).norm(), 1e-5 * all.radius);
    const bool middle = static_cast<int>(held.pixel) == mask.rows / 2 * mask.cols + mask.cols / 2;
    EXPECT_EQ(all.at_white[held.at], middle ? kAtWhite : kBesideWhite);
    EXPECT_EQ(all.IsAtWhite(held.at), middle);
    at_white += middle ? 1 : 0;
  }
  EXPECT_EQ(at_white, 1);
  HoldBack(all);
  EXPECT_EQ(all.pixel, before.pixel);
  EXPECT_EQ(all.used, before.used);
  EXPECT_FALSE(all.IsAtWhite(all.held_back[4].at));
  Observations joined = Concatenate({BuildPart(built.keyframes[0], built.geometry, built.rays),
                                     BuildPart(built.keyframes[1], built.geometry, built.rays)});
  EXPECT_EQ(joined.pixel, before.pixel);
  TakeHeldBack(joined);
  EXPECT_EQ(joined.pixel, plain.pixel);
}

// One keyframe's part put into the frame of all is that keyframe in all: with and without weights,
// and with radiances far from white.
TEST(Observations, APartInTheFrameOfAllIsItsKeyframe) {
  for (const float level : {1.0f, 1e-3f})
    for (const bool weighted : {false, true}) {
      Built built(FloatPictures(3));
      for (model::Keyframe& keyframe : built.keyframes) {
        keyframe.image.radiance *= level;
        if (!weighted) continue;
        cv::Mat grey;
        cv::transform(keyframe.image.radiance, grey, cv::Matx13f(0.01f, 0.01f, 0.01f));
        keyframe.image.variance = level * grey;
      }
      const Observations all = BuildObservations(built.keyframes, built.geometry, built.rays);
      ASSERT_EQ(all.weighted, weighted);
      Observations part = BuildPart(built.keyframes[1], built.geometry, built.rays);
      CompleteIn(FrameOf(all), part);
      EXPECT_EQ(part.radiance_unit, all.radiance_unit);
      EXPECT_EQ(part.channels, all.channels);
      const std::size_t first = all.tile_begin[1] * kTile;
      ASSERT_EQ(part.size(), all.tile_begin[2] * kTile - first);
      for (std::size_t i = 0; i < part.size(); ++i) {
        if (part.pixel[i] == Observations::kNoPixel) continue;
        ASSERT_EQ(part.pixel[i], all.pixel[first + i]);
        ASSERT_EQ(part.radiance[1][i], all.radiance[1][first + i]);
        ASSERT_LT((At(part.position, i) - At(all.position, first + i)).norm(), 1e-6);
        ASSERT_NEAR(part.WeightOf(i), all.WeightOf(first + i), 1e-6);
      }
    }
}

TEST(Observations, SamplesHaveTheSizeAskedFor) {
  const Built built(FloatPictures(2));
  const Observations all = BuildObservations(built.keyframes, built.geometry, built.rays);
  constexpr std::size_t kCount = 1500;
  ASSERT_GT(all.used, 2 * kCount);
  const double scatter = 5.0 * std::sqrt(static_cast<double>(kCount));
  EXPECT_NEAR(static_cast<double>(Subsample(all, kCount, 3).used), kCount, scatter);
  EXPECT_NEAR(static_cast<double>(EvenSubsample(all, kCount, 3, nullptr).used), kCount, scatter);
  EXPECT_EQ(EvenSubsample(all, 10 * all.used, 3, nullptr).used, all.used);
  EXPECT_NE(Subsample(all, kCount, 3).pixel, Subsample(all, kCount, 4).pixel);
  EXPECT_EQ(Subsample(all, kCount, 3).pixel, Subsample(all, kCount, 3).pixel);
  // Of those that are usable only.
  std::vector<std::uint8_t> usable(all.size(), std::uint8_t{0});
  std::fill(usable.begin(), usable.begin() + 100, std::uint8_t{1});
  EXPECT_EQ(EvenSubsample(all, kCount, 3, &usable).used, 100u);
}

}  // namespace
}  // namespace turnlight::estimator::observe
