// Proves: a target is found against the empty table and before a dark background; a shadow is told
// from it by its colour, and reported where there is none; what shows no target is refused.
#include "calib/calibrate/placement/segment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "base/random.h"

namespace turnlight::calib::calibrate::placement {
namespace {

using testing::HasSubstr;

constexpr double kArea = CV_PI * 40 * 40;

cv::Mat3f Table(std::uint64_t seed, const cv::Scalar& colour = {0.3, 0.35, 0.4}) {
  cv::Mat3f picture(200, 300);
  const RandomStream random(seed, 0);
  for (int i = 0; i < static_cast<int>(picture.total()); ++i)
    for (int c = 0; c < 3; ++c)
      picture(i)[c] = static_cast<float>(
          colour[c] + 0.003 * random.Normal(static_cast<std::uint64_t>(3 * i + c)));
  return picture;
}

cv::Mat3f WithBall(cv::Mat3f picture, bool shadow) {
  if (shadow) {
    cv::Mat1b dark(picture.size(), uchar{0});
    cv::ellipse(dark, {205, 120}, {40, 20}, 0, 0, 360, 255, cv::FILLED);
    picture.copyTo(picture);
    cv::Mat3f half = picture * 0.5;
    half.copyTo(picture, dark);
  }
  cv::circle(picture, {150, 100}, 40, {0.7, 0.5, 0.2}, cv::FILLED);
  return picture;
}

cv::Mat Grey(const cv::Mat3f& picture) {
  std::vector<cv::Mat> parts;
  cv::split(picture, parts);
  return parts[1];
}

TEST(Segment, FindsWhatDiffersFromTheEmptyTable) {
  const auto found = SegmentAgainstEmpty(WithBall(Table(1), false), Table(2));
  ASSERT_TRUE(found) << found.error().text;
  EXPECT_NEAR(cv::countNonZero(found->mask), kArea, 0.03 * kArea);
  EXPECT_NEAR(found->noise, 0.003 * std::sqrt(2.0), 0.0005);
  EXPECT_FALSE(found->touches_border);
  EXPECT_FALSE(found->shadow_removed);
}

// Of 8 bits a dark background is 0 nearly everywhere, and 1 or 2 where its noise is.
TEST(Segment, ABackgroundOfFewValuesIsDark) {
  cv::Mat3f picture = WithBall(Table(1, {0.0, 0.0, 0.0}), false);
  for (int i = 0; i < static_cast<int>(picture.total()); ++i)
    for (int c = 0; c < 3; ++c)
      picture(i)[c] = std::round(255.0f * std::max(0.0f, picture(i)[c])) / 255.0f;
  const auto found = SegmentBright(picture);
  ASSERT_TRUE(found) << found.error().text;
  EXPECT_NEAR(cv::countNonZero(found->mask), kArea, 0.03 * kArea);
}

TEST(Segment, TakesAShadowAwayByItsColour) {
  const auto found = SegmentAgainstEmpty(WithBall(Table(1), true), Table(2));
  ASSERT_TRUE(found) << found.error().text;
  EXPECT_TRUE(found->shadow_removed);
  EXPECT_GT(found->shadow_share, 0.1);
  EXPECT_NEAR(cv::countNonZero(found->mask), kArea, 0.04 * kArea);
}

TEST(Segment, OfAGreyPictureAShadowIsOnlyReported) {
  const auto found = SegmentAgainstEmpty(Grey(WithBall(Table(1), true)), Grey(Table(2)));
  ASSERT_TRUE(found) << found.error().text;
  EXPECT_FALSE(found->shadow_removed);
  EXPECT_GT(found->shadow_share, 0.1);
}

TEST(Segment, FindsABrightTargetBeforeADarkBackground) {
  const auto found = SegmentBright(WithBall(Table(1, {0.01, 0.01, 0.01}), false));
  ASSERT_TRUE(found) << found.error().text;
  EXPECT_NEAR(cv::countNonZero(found->mask), kArea, 0.03 * kArea);
}

TEST(Segment, SaysThatTheTargetLeavesThePicture) {
  cv::Mat3f picture = Table(1, {0.01, 0.01, 0.01});
  cv::circle(picture, {20, 100}, 40, {0.7, 0.5, 0.2}, cv::FILLED);
  const auto found = SegmentBright(picture);
  ASSERT_TRUE(found) << found.error().text;
  EXPECT_TRUE(found->touches_border);
}

TEST(Segment, RefusesWhatShowsNoTarget) {
  const auto same = SegmentAgainstEmpty(Table(1), Table(2));
  ASSERT_FALSE(same);
  EXPECT_THAT(same.error().text, HasSubstr("nothing in it differs"));
  const auto size = SegmentAgainstEmpty(Table(1), Table(2)(cv::Rect(0, 0, 100, 100)));
  ASSERT_FALSE(size);
  EXPECT_THAT(size.error().text, HasSubstr("100 x 100"));
  cv::Mat3f bright = Table(1, {0.6, 0.6, 0.6});
  cv::circle(bright, {150, 100}, 40, {0.05, 0.05, 0.05}, cv::FILLED);
  const auto inverse = SegmentBright(bright);
  ASSERT_FALSE(inverse);
  EXPECT_THAT(inverse.error().text, HasSubstr("background is not dark"));
  EXPECT_THAT(SegmentBright(cv::Mat3f(20, 20, cv::Vec3f())).error().text, HasSubstr("all dark"));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::placement
