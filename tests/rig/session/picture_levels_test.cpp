// Proves: pictures of fewer bits than white says, on either side of their bytes, and pictures that
// are clipped below saturation are told with the value to set; noise, smooth peaks, flat areas, hot
// pixels and pictures that are as the session says are not. Does not prove: that no picture is
// accused falsely; the sessions that the tests at hand read are not.
#include "rig/session/picture_levels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace turnlight::rig {
namespace {

using testing::HasSubstr;

// A highlight of `peak` times white on a ball, with noise of `noise` of white.
cv::Mat1d Ball(double peak, double noise, int seed = 1) {
  cv::Mat1d light(120, 160);
  cv::RNG random(static_cast<std::uint64_t>(seed));
  for (int y = 0; y < light.rows; ++y)
    for (int x = 0; x < light.cols; ++x) {
      const double r2 = std::pow((x - 75.0 - seed) / 50.0, 2) + std::pow((y - 60.0) / 50.0, 2);
      const double lit = r2 < 1.0 ? 0.4 * std::sqrt(1.0 - r2) : 0.0;
      light(y, x) = lit + std::max(0.0, peak - 0.4) * std::exp(-12.0 * r2) + random.gaussian(noise);
    }
  return light;
}

// As a camera of `bits` stores it, each value times `step`.
cv::Mat Stored(const cv::Mat1d& light, int bits, double step, int type = CV_16U) {
  const double full = std::exp2(bits) - 1.0;
  cv::Mat1d values(light.size());
  for (int y = 0; y < light.rows; ++y)
    for (int x = 0; x < light.cols; ++x)
      values(y, x) = step * std::clamp(std::round(full * light(y, x)), 0.0, full);
  cv::Mat stored;
  values.convertTo(stored, type);
  return stored;
}

std::string TextOf(const std::vector<cv::Mat>& pictures, double white,
                   std::optional<double> saturation = {}) {
  calib::Radiometry radiometry;
  radiometry.white = white;
  radiometry.saturation = saturation;
  std::vector<PictureLevels> levels;
  for (const cv::Mat& picture : pictures)
    levels.push_back(MeasureLevels(picture, cv::Mat1b(picture.size(), 255)));
  return LevelsText(radiometry, levels);
}

std::vector<cv::Mat> Series(double peak, double noise, int bits, double step, int type = CV_16U) {
  std::vector<cv::Mat> pictures;
  for (int i = 0; i < 4; ++i) pictures.push_back(Stored(Ball(peak, noise, i), bits, step, type));
  return pictures;
}

TEST(PictureLevels, TwelveBitsOnTheLeftOfSixteen) {
  for (const double peak : {0.7, 1.5}) {
    EXPECT_THAT(TextOf(Series(peak, 0.01, 12, 16.0), 65535), HasSubstr("set \"saturation\": 65520"))
        << peak;
    EXPECT_EQ(TextOf(Series(peak, 0.01, 12, 16.0), 65535, 65520), "");
    EXPECT_EQ(TextOf(Series(peak, 0.01, 12, 16.0), 65520), "");
  }
  EXPECT_THAT(TextOf(Series(0.7, 0.01, 12, 16.0), 65535), HasSubstr("12 bits, left-aligned in 16"));
}

TEST(PictureLevels, TwelveBitsOnTheRightOfSixteen) {
  EXPECT_THAT(TextOf(Series(1.5, 0.01, 12, 1.0), 65535),
              testing::AllOf(HasSubstr("4 of 4 pictures are clipped at 4095"),
                             HasSubstr("set \"white\": 4095")));
  EXPECT_THAT(TextOf(Series(0.7, 0.01, 12, 1.0), 65535),
              testing::AllOf(HasSubstr("no value exceeds"), HasSubstr("set \"white\": 4095")));
  EXPECT_EQ(TextOf(Series(1.5, 0.01, 12, 1.0), 4095), "");
  EXPECT_EQ(TextOf(Series(0.7, 0.01, 12, 1.0), 4095), "");
  // Whole numbers that come as floats are no different.
  EXPECT_THAT(TextOf(Series(1.5, 0.01, 12, 1.0, CV_32F), 65535), HasSubstr("\"white\": 4095"));
}

TEST(PictureLevels, ClippingBelowSaturation) {
  std::vector<cv::Mat> pictures = Series(1.5, 0.01, 16, 1.0),
                       bytes = Series(1.5, 0.01, 8, 1.0, CV_8U);
  for (cv::Mat& picture : pictures) picture = cv::min(picture, 60000);
  for (cv::Mat& picture : bytes) picture = cv::min(picture, 235);
  EXPECT_THAT(TextOf(pictures, 65535), HasSubstr("set \"saturation\": 60000"));
  EXPECT_THAT(TextOf(bytes, 255), HasSubstr("set \"saturation\": 235"));
  EXPECT_EQ(TextOf(pictures, 65535, 60000), "");
  // A few hot pixels above do not hide it.
  for (cv::Mat& picture : pictures) picture.at<std::uint16_t>(3, 3) = 65535;
  EXPECT_THAT(TextOf(pictures, 65535), HasSubstr("set \"saturation\": 60000"));
  // One picture alone is not enough, unless there is only one.
  EXPECT_EQ(TextOf({pictures[0], Stored(Ball(0.7, 0.01), 16, 1.0)}, 65535), "");
  EXPECT_THAT(TextOf({pictures[0]}, 65535), HasSubstr("60000"));
}

TEST(PictureLevels, NothingIsSaidOfPicturesThatAreAsTheyShouldBe) {
  for (const double noise : {0.0, 0.003, 0.02})
    for (const double peak : {0.4, 0.7, 0.99, 1.5}) {
      EXPECT_EQ(TextOf(Series(peak, noise, 16, 1.0), 65535), "") << peak << " " << noise;
      EXPECT_EQ(TextOf(Series(peak, noise, 8, 1.0, CV_8U), 255), "") << peak << " " << noise;
      EXPECT_EQ(TextOf(Series(peak, noise, 8, 257.0), 65535), "") << peak << " " << noise;
    }
}

// Rendered without noise: the same flat wall in all, a ridge, a plane in even light.
TEST(PictureLevels, NothingIsSaidOfFlatAreasAndRidges) {
  const auto drawn = [](const std::function<double(int, int)>& light) {
    cv::Mat1d picture(120, 160);
    for (int y = 0; y < 120; ++y)
      for (int x = 0; x < 160; ++x) picture(y, x) = light(x, y);
    return picture;
  };
  const cv::Mat1d wall =
      drawn([](int x, int y) { return x < 80 ? 0.9 : 0.5 * std::sin(0.01 * (x + y)); });
  const cv::Mat1d ridge = drawn([](int x, int) { return 0.8 * std::cos((x - 80.3) / 60.0); });
  const cv::Mat1d plane = drawn([](int x, int) { return x > 30 ? 0.7 : 0.0; });
  for (const cv::Mat1d& light : {wall, ridge, plane}) {
    EXPECT_EQ(TextOf({Stored(light, 16, 1.0), Stored(light, 16, 1.0)}, 65535), "");
    const cv::Mat bytes = Stored(light, 8, 1.0, CV_8U);
    EXPECT_EQ(TextOf({bytes, bytes}, 255), "");
  }
}

TEST(PictureLevels, NothingIsSaidOfFloatsAndOfBlack) {
  cv::Mat floats;
  Ball(1.5, 0.01).convertTo(floats, CV_32F);
  EXPECT_FALSE(MeasureLevels(floats, cv::Mat1b(floats.size(), 255)).whole);
  EXPECT_EQ(TextOf({floats, floats}, 1.0), "");
  EXPECT_EQ(TextOf({cv::Mat::zeros(9, 9, CV_16U)}, 65535), "");
}

}  // namespace
}  // namespace turnlight::rig
