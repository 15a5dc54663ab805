// Proves that JPEG photographs give the values that libjpeg gives others, grey or as they are
// stored, that the turn that EXIF asks for is told and not made, and that damage is refused. Does
// not test what photographs are good for.
#include "rig/session/jpeg_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace turnlight::rig {
namespace {

using testing::HasSubstr;

// B, G, R as imgcodecs has them.
cv::Mat3b Ramp() {
  cv::Mat3b picture(24, 40);
  for (int row = 0; row < picture.rows; ++row)
    for (int column = 0; column < picture.cols; ++column)
      picture(row, column) = cv::Vec3b(static_cast<std::uint8_t>(5 * column),
                                       static_cast<std::uint8_t>(8 * row), 100);
  return picture;
}

std::string ToJpeg(const cv::Mat& picture) {
  std::vector<std::uint8_t> bytes;
  EXPECT_TRUE(cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, 95}));
  return {bytes.begin(), bytes.end()};
}

cv::Mat FromJpeg(const std::string& text, int flags) {
  return cv::imdecode(std::vector<std::uint8_t>(text.begin(), text.end()), flags);
}

TEST(JpegFile, ColourComesAsStoredOrGrey) {
  const std::string bytes = ToJpeg(Ramp());
  const auto colour = DecodeJpeg(bytes, "a.jpg", JpegChannels::kAsStored);
  ASSERT_TRUE(colour) << colour.error().text;
  ASSERT_EQ(colour->image.type(), CV_8UC3);
  cv::Mat rgb;
  cv::cvtColor(FromJpeg(bytes, cv::IMREAD_COLOR), rgb, cv::COLOR_BGR2RGB);
  EXPECT_EQ(cv::norm(colour->image, rgb, cv::NORM_INF), 0.0);
  const auto grey = DecodeJpeg(bytes, "a.jpg");
  ASSERT_TRUE(grey) << grey.error().text;
  ASSERT_EQ(grey->image.type(), CV_8UC1);
  EXPECT_EQ(cv::norm(grey->image, FromJpeg(bytes, cv::IMREAD_GRAYSCALE), cv::NORM_INF), 0.0);
  EXPECT_EQ(grey->orientation, 1);
}

TEST(JpegFile, GreyStaysGrey) {
  cv::Mat grey;
  cv::cvtColor(Ramp(), grey, cv::COLOR_BGR2GRAY);
  const auto picture = DecodeJpeg(ToJpeg(grey), "a.jpg", JpegChannels::kAsStored);
  ASSERT_TRUE(picture) << picture.error().text;
  EXPECT_EQ(picture->image.type(), CV_8UC1);
}

TEST(JpegFile, TheTurnThatExifAsksForIsToldAndNotMade) {
  std::string bytes = ToJpeg(Ramp());
  const std::string exif(
      "\xff\xe1\x00\x22"
      "Exif\0\0MM\0\x2a\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0",
      36);
  bytes.insert(2, exif);
  const auto picture = DecodeJpeg(bytes, "a.jpg");
  ASSERT_TRUE(picture) << picture.error().text;
  EXPECT_EQ(picture->orientation, 6);
  EXPECT_EQ(picture->image.size(), cv::Size(40, 24));
}

TEST(JpegFile, DamageIsRefused) {
  const std::string bytes = ToJpeg(Ramp());
  const auto refusal = [](const std::string& damaged) {
    const auto picture = DecodeJpeg(damaged, "a.jpg");
    return picture ? std::string("read") : picture.error().text;
  };
  EXPECT_THAT(refusal("no picture"), HasSubstr("a.jpg: not a JPEG file"));
  for (const std::size_t length : {4u, 100u, 300u})
    EXPECT_THAT(refusal(bytes.substr(0, length)), HasSubstr("damaged or truncated")) << length;
  EXPECT_THAT(refusal(bytes.substr(0, bytes.size() - 20)), HasSubstr("damaged or truncated"));
}

}  // namespace
}  // namespace turnlight::rig
