// Proves: JPEG photographs come as the sensor has them, whatever EXIF asks for; damaged, cut and
// hostile files are errors with the file's name.
#include "rig/session/jpeg_file.h"

#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>

#include "tests/rig/session/jpeg_writer.h"

namespace turnlight::rig {
namespace {

using testing::HasSubstr;

cv::Mat Ramp() {
  cv::Mat image(60, 80, CV_8U);
  for (int row = 0; row < image.rows; ++row)
    for (int column = 0; column < image.cols; ++column)
      image.at<unsigned char>(row, column) = static_cast<unsigned char>(2 * column + row);
  return image;
}

std::string TextOf(const std::string& bytes) {
  const auto picture = DecodeJpeg(bytes, "photo.jpg");
  return picture ? std::string() : picture.error().text;
}

TEST(DecodeJpeg, GreyColourAndProgressive) {
  cv::Mat colour;
  cv::cvtColor(Ramp(), colour, cv::COLOR_GRAY2RGB);
  for (const std::string& bytes :
       {WriteJpeg(Ramp()), WriteJpeg(colour), WriteJpeg(colour, 0, true)}) {
    const auto picture = DecodeJpeg(bytes, "photo.jpg");
    ASSERT_TRUE(picture) << picture.error().text;
    ASSERT_EQ(picture->image.size(), cv::Size(80, 60));
    EXPECT_LE(cv::norm(picture->image, Ramp(), cv::NORM_INF), 4.0);
    EXPECT_EQ(picture->orientation, 1);
  }
}

TEST(DecodeJpeg, ColourComesAsItIsStoredIfAskedFor) {
  cv::Mat3b colour(60, 80);
  for (int row = 0; row < colour.rows; ++row)
    for (int column = 0; column < colour.cols; ++column)
      colour(row, column) = {static_cast<unsigned char>(2 * column),
                             static_cast<unsigned char>(3 * row), 100};
  const auto stored = DecodeJpeg(WriteJpeg(colour), "photo.jpg", JpegChannels::kAsStored);
  ASSERT_TRUE(stored) << stored.error().text;
  ASSERT_EQ(stored->image.type(), CV_8UC3);
  EXPECT_LE(cv::norm(stored->image, colour, cv::NORM_INF), 8.0);  // R, G, B in their order
  const auto grey = DecodeJpeg(WriteJpeg(Ramp()), "photo.jpg", JpegChannels::kAsStored);
  ASSERT_TRUE(grey) << grey.error().text;
  EXPECT_EQ(grey->image.type(), CV_8UC1);
}

TEST(DecodeJpeg, ExifIsToldAndNotObeyed) {
  const auto picture = DecodeJpeg(WriteJpeg(Ramp(), 6), "photo.jpg");
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->orientation, 6);
  EXPECT_EQ(picture->image.size(), cv::Size(80, 60));
}

TEST(DecodeJpeg, RefusesWhatIsDamaged) {
  const std::string good = WriteJpeg(Ramp());
  EXPECT_THAT(TextOf(""), HasSubstr("photo.jpg: not a JPEG"));
  EXPECT_THAT(TextOf("\x89PNG\r\n"), HasSubstr("not a JPEG"));
  EXPECT_THAT(TextOf(good.substr(0, good.size() / 2)),
              HasSubstr("photo.jpg: damaged or truncated"));
  EXPECT_THAT(TextOf(good.substr(0, 30)), HasSubstr("damaged or truncated"));
  // Its size says 65500 x 65500.
  std::string huge = good;
  const std::size_t frame = huge.find("\xff\xc0");
  ASSERT_NE(frame, std::string::npos);
  for (const std::size_t at : {frame + 5, frame + 7}) {
    huge[at] = '\xff';
    huge[at + 1] = '\xdc';
  }
  EXPECT_THAT(TextOf(huge), HasSubstr("65500 x 65500"));
}

TEST(DecodeJpeg, SurvivesAnyByteBeingWrong) {
  const std::string good = WriteJpeg(Ramp(), 3);
  for (std::size_t i = 3; i < good.size(); ++i)
    for (const char change : {'\xff', '\x00', '\x7f'}) {
      std::string bad = good;
      bad[i] = change;
      const auto picture = DecodeJpeg(bad, "photo.jpg");
      if (picture) {
        EXPECT_FALSE(picture->image.empty());
      }
    }
}

}  // namespace
}  // namespace turnlight::rig
