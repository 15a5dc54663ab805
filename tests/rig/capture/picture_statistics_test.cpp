// Proves: levels of each channel in closed form, of colour, grey and mosaics; what is clipped,
// black or no number is counted once. Does not prove: what to do about it; frame_check_test does.
#include "rig/capture/picture_statistics.h"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

namespace turnlight::rig {
namespace {

calib::Radiometry TenToHundredAndTen() {
  calib::Radiometry radiometry;
  radiometry.black = 10.0;
  radiometry.white = 110.0;
  return radiometry;
}

TEST(PictureStatistics, GreyInClosedForm) {
  cv::Mat1w image(1, 5);
  image << 4, 10, 60, 110, 200;
  const auto channels = MeasureChannels(image, TenToHundredAndTen());
  ASSERT_EQ(channels.size(), 1u);
  EXPECT_EQ(channels[0].name, "grey");
  EXPECT_EQ(channels[0].min, 4.0);
  EXPECT_EQ(channels[0].median, 60.0);
  EXPECT_DOUBLE_EQ(channels[0].mean, 384.0 / 5.0);
  EXPECT_EQ(channels[0].max, 200.0);
  EXPECT_DOUBLE_EQ(channels[0].clipped_share, 0.4);
  EXPECT_DOUBLE_EQ(channels[0].black_share, 0.4);
  EXPECT_EQ(channels[0].histogram.front(), 2u);
  EXPECT_EQ(channels[0].histogram[kLevelBins / 2], 1u);
  EXPECT_EQ(channels[0].histogram.back(), 2u);
}

TEST(PictureStatistics, ColoursAndMosaics) {
  const cv::Mat colour(4, 6, CV_8UC3, cv::Scalar(20, 30, 40));
  const auto rgb = MeasureChannels(colour, TenToHundredAndTen());
  ASSERT_EQ(rgb.size(), 3u);
  EXPECT_EQ(rgb[0].name + rgb[1].name + rgb[2].name, "RGB");
  EXPECT_EQ(rgb[2].mean, 40.0);
  cv::Mat1b mosaic(4, 6);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 6; ++x)
      mosaic(y, x) = static_cast<std::uint8_t>(20 + 10 * (y % 2) + 10 * (x % 2));
  const auto sites = MeasureChannels(mosaic, TenToHundredAndTen(), "RGGB");
  ASSERT_EQ(sites.size(), 3u);
  EXPECT_EQ(sites[0].mean, 20.0);
  EXPECT_EQ(sites[1].mean, 30.0);
  EXPECT_EQ(sites[2].mean, 40.0);
  EXPECT_EQ(std::accumulate(sites[1].histogram.begin(), sites[1].histogram.end(), 0u), 12u);
  EXPECT_EQ(MeasureChannels(mosaic, TenToHundredAndTen(), "BGGR")[0].mean, 40.0);
}

TEST(PictureStatistics, NoNumberIsClipped) {
  cv::Mat1f image(1, 4, 60.0f);
  image(0, 0) = std::numeric_limits<float>::quiet_NaN();
  image(0, 1) = std::numeric_limits<float>::infinity();
  const auto channels = MeasureChannels(image, TenToHundredAndTen());
  EXPECT_DOUBLE_EQ(channels[0].clipped_share, 0.5);
  EXPECT_EQ(channels[0].mean, 60.0);
}

}  // namespace
}  // namespace turnlight::rig
