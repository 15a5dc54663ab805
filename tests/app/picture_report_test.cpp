// Proves: the words of a single picture: what kind it is, bars that show every bin with a pixel,
// numbers of each channel, and advice with the line for a config. Does not prove: the numbers;
// rig/capture/picture_statistics_test and frame_check_test do.
#include "app/picture_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace turnlight::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;

calib::Radiometry TwelveBits() {
  calib::Radiometry radiometry;
  radiometry.black = 100.0;
  radiometry.white = 4095.0;
  return radiometry;
}

TEST(PictureReport, BarsShowEveryPixel) {
  std::array<std::size_t, rig::kLevelBins> counts{};
  counts[0] = 1000000;
  counts[1] = 1;
  counts[39] = 1000;
  const std::string bars = HistogramBars(counts);
  EXPECT_TRUE(bars.starts_with("\u2588\u2581 ")) << bars;
  EXPECT_TRUE(bars.ends_with(" \u2584")) << bars;
  EXPECT_EQ(HistogramBars({}), std::string(rig::kLevelBins, ' '));
}

TEST(PictureReport, KindsOfPictures) {
  EXPECT_EQ(PictureKind(cv::Mat(48, 64, CV_8U), std::nullopt), "64 x 48 pixels, 8 bits, grey");
  EXPECT_EQ(PictureKind(cv::Mat(48, 64, CV_16UC3), std::nullopt),
            "64 x 48 pixels, 16 bits, R, G, B");
  EXPECT_EQ(PictureKind(cv::Mat(48, 64, CV_16U), "RGGB"),
            "64 x 48 pixels, 16 bits, the raw Bayer mosaic RGGB of one channel");
}

TEST(PictureReport, LevelsAndAdvice) {
  const cv::Mat dark(60, 80, CV_16U, cv::Scalar(100 + 160));
  EXPECT_THAT(LevelsText(dark, TwelveBits(), std::nullopt),
              AllOf(HasSubstr("black 100, white 4095"), HasSubstr("grey"), HasSubstr("260")));
  EXPECT_THAT(
      AdviceText(dark, TwelveBits(), 800.0),
      AllOf(HasSubstr("mean level 4 % of white: multiply the exposure by 20; in the config: "
                      "capture: {exposures_us: [16000]}"),
            HasSubstr("a capture would keep this picture")));
  const cv::Mat white(60, 80, CV_16U, cv::Scalar(4095));
  EXPECT_THAT(
      AdviceText(white, TwelveBits(), 8000.0),
      AllOf(HasSubstr("[1000]"), HasSubstr("a capture would refuse this picture: saturated")));
  const cv::Mat good(60, 80, CV_16U, cv::Scalar(3300));
  EXPECT_THAT(AdviceText(good, TwelveBits(), 8000.0), HasSubstr("the exposure uses the range"));
}

}  // namespace
}  // namespace turnlight::app
