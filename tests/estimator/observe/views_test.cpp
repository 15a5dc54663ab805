// Proves: a signature is every third pixel; a view counts if its picture differs by more than noise
// from all that counted before, whatever it cannot compare being left out. Does not prove that the
// scenes of distinct views differ.
#include "estimator/observe/views.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/random.h"

namespace turnlight::estimator::observe {
namespace {

cv::Mat NoisyView(double level, double sigma, std::uint64_t seed) {
  cv::Mat1f view(20, 30);
  const RandomStream random(seed, 1);
  std::uint64_t draw = 0;
  for (float& value : view) value = static_cast<float>(level + sigma * random.Normal(draw++));
  return view;
}

TEST(ViewSignature, IsEveryThirdPixel) {
  model::Keyframe keyframe;
  cv::Mat3f picture(7, 10);
  for (int row = 0; row < 7; ++row)
    for (int column = 0; column < 10; ++column)
      picture(row, column) = cv::Vec3f(static_cast<float>(row), static_cast<float>(column), 5.0f);
  keyframe.image.radiance = picture;
  const cv::Mat3f signature = ViewSignature(keyframe);
  ASSERT_EQ(signature.size(), cv::Size(4, 3));
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      EXPECT_EQ(signature(row, column), picture(3 * row, 3 * column));
}

// However large a picture is, what is kept of it is not.
TEST(ViewSignature, IsBounded) {
  model::Keyframe keyframe;
  keyframe.image.radiance = cv::Mat1f(1500, 2000, 0.5f);
  const cv::Mat1f signature = ViewSignature(keyframe);
  EXPECT_LE(signature.total(), 101'000u);
  EXPECT_GE(signature.total(), 70'000u);
}

TEST(DistinctViews, NoiseAloneMakesNone) {
  const std::vector<cv::Mat> same = {NoisyView(0.5, 0.01, 1), NoisyView(0.5, 0.01, 2),
                                     NoisyView(0.5, 0.01, 3)};
  EXPECT_EQ(DistinctViews(same, LikeLimit(0.01)), 1);
  EXPECT_EQ(DistinctViews(same, LikeLimit(0.005)), 3) << "the noise is twice what was said";
  EXPECT_EQ(DistinctViews({}, 0.01), 0);
}

// Two pictures of noise sigma are sqrt(2) sigma apart; the limit is 1.5 times that.
TEST(DistinctViews, ADifferenceBeyondNoiseCounts) {
  const auto pair = [](double apart) {
    return DistinctViews({NoisyView(0.5, 0.0, 1), NoisyView(0.5 + apart, 0.0, 2)}, LikeLimit(0.01));
  };
  EXPECT_EQ(pair(0.0205), 1);
  EXPECT_EQ(pair(0.0220), 2);
}

TEST(DistinctViews, AViewThatComesBackIsNotNew) {
  std::vector<cv::Mat> views;
  for (const double level : {0.1, 0.2, 0.1, 0.3, 0.2}) views.push_back(NoisyView(level, 0.0, 1));
  EXPECT_EQ(DistinctViews(views, 0.01), 3);
}

TEST(DistinctViews, WhatIsNotFiniteIsLeftOutAndOtherSizesAreOthers) {
  cv::Mat1f hole = NoisyView(0.5, 0.0, 1);
  hole(3, 4) = std::numeric_limits<float>::infinity();
  EXPECT_EQ(DistinctViews({NoisyView(0.5, 0.0, 1), hole}, 0.01), 1);
  EXPECT_EQ(DistinctViews({cv::Mat1f(2, 2, 0.5f), cv::Mat1f(2, 3, 0.5f)}, 0.01), 2);
}

}  // namespace
}  // namespace turnlight::estimator::observe
