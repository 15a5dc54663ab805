// Proves, on rendered balls: with clipped highlights the estimate is better where pixels at white
// and beside them are taken in than where they are left out, and not much worse than without
// clipping; where charge has spilled over from them they are left out; the sigmas stay those of the
// errors. Does not prove that all kinds of blooming are seen: ours goes to the next pixel.
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "base/angles.h"
#include "estimator/estimate.h"
#include "rig/sim/synthetic_session.h"
#include "tests/estimator/small_scene.h"

namespace turnlight::estimator {
namespace {

constexpr double kShininess = 30.0;

rig::sim::SyntheticConfig Ball(std::uint64_t seed, double clip_share) {
  rig::sim::SyntheticConfig config = TwoLightBall(seed, 0.002, 0.05);
  auto& reflectance = std::get<model::Reflectance>(config.reflectance);
  reflectance.lobes[0].strength = 0.8;
  config.sensor.clip_share = clip_share;
  return config;
}

std::vector<model::Keyframe> Pictures(std::uint64_t seed, double clip_share) {
  const auto session = rig::sim::SynthesizeInMemory(Ball(seed, clip_share));
  EXPECT_TRUE(session) << session.error().text;
  return rig::sim::ToKeyframes(*session);
}

EstimateOutput Estimated(const std::vector<model::Keyframe>& keyframes) {
  const auto session = rig::sim::SynthesizeInMemory(Ball(1, 0.0));
  auto out = EstimateScene(keyframes, target::Geometry(session->target),
                           calib::RayGrid(session->camera), EstimateOptions());
  EXPECT_TRUE(out) << out.error().text;
  return *out;
}

// Of the rung: whether it is there, and was accepted; and in which words.
struct Taken {
  bool asked = false, accepted = false;
  std::string why;
};
Taken TakenIn(const Estimate& estimate) {
  for (const model::Rung& rung : estimate.ladder)
    if (rung.rung == "clipped") return {true, rung.accepted, rung.why};
  return {};
}

double ShininessError(const Estimate& estimate) {
  return std::abs(estimate.reflectance.lobes[0].shape / kShininess - 1.0);
}

// The pixels beside those at white get 0.3 of white for the share of these around them.
void Bloom(std::vector<model::Keyframe>& keyframes) {
  for (model::Keyframe& keyframe : keyframes) {
    cv::Mat1f spilt;
    cv::Mat1b(keyframe.image.saturated != 0).convertTo(spilt, CV_32F, 1.0 / 255.0);
    cv::blur(spilt, spilt, {3, 3});
    cv::Mat radiance = keyframe.image.radiance.clone();
    for (int y = 0; y < radiance.rows; ++y)
      for (int x = 0; x < radiance.cols; ++x)
        if (keyframe.image.saturated(y, x) == 0)
          radiance.at<cv::Vec3f>(y, x) += cv::Vec3f::all(0.3f * spilt(y, x));
    keyframe.image.radiance = radiance;
  }
}

TEST(ClippedPixels, WhatIsAtWhiteAndBesideItTellsOfTheLights) {
  double with = 0.0, without = 0.0, unclipped = 0.0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    auto pictures = Pictures(seed, 0.02);
    const Estimate clipped = Estimated(pictures).estimate;
    EXPECT_TRUE(TakenIn(clipped).accepted) << TakenIn(clipped).why;
    EXPECT_EQ(clipped.lights.size(), 2u);
    with += ShininessError(clipped);
    unclipped += ShininessError(Estimated(Pictures(seed, 0.0)).estimate);
    // Implausible ones and their neighbours are left out as they always are.
    for (model::Keyframe& keyframe : pictures)
      keyframe.image.radiance.setTo(cv::Scalar::all(1e9), keyframe.image.saturated);
    const Estimate left_out = Estimated(pictures).estimate;
    EXPECT_FALSE(TakenIn(left_out).asked);
    without += ShininessError(left_out);
    const std::optional<double> sigma = clipped.sigma.lobes[0].shape;
    ASSERT_TRUE(sigma.has_value());
    EXPECT_LT(ShininessError(clipped) * kShininess, 4.0 * *sigma);
  }
  RecordProperty("with", std::to_string(with));
  RecordProperty("without", std::to_string(without));
  RecordProperty("unclipped", std::to_string(unclipped));
  EXPECT_LT(with, without);
  EXPECT_LT(with, 4.0 * unclipped);
}

TEST(ClippedPixels, WhereChargeHasSpilledOverTheyAreLeftOut) {
  auto pictures = Pictures(1, 0.02);
  Bloom(pictures);
  const Estimate bloomed = Estimated(pictures).estimate;
  EXPECT_TRUE(TakenIn(bloomed).asked);
  EXPECT_FALSE(TakenIn(bloomed).accepted) << TakenIn(bloomed).why;
  EXPECT_LT(ShininessError(bloomed), 0.05);
}

TEST(ClippedPixels, WithoutAnyNothingIsAsked) {
  EXPECT_FALSE(TakenIn(Estimated(Pictures(1, 0.0)).estimate).asked);
}

}  // namespace
}  // namespace turnlight::estimator
