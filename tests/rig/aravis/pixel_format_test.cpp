// Proves, against bytes written by hand from the format's definition: each layout gives the values
// that the bytes mean, with rows that end within a byte, and rows that are padded; too few bytes
// and values beyond the depth are refused. Does not prove: that a camera sends what its format
// says.
#include "rig/aravis/pixel_format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace turnlight::rig::aravis {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

Result<cv::Mat> UnpackAs(const std::string& name, const Bytes& bytes, cv::Size size,
                         int padding = 0) {
  return Unpack(bytes, size, padding, FindPixelFormat(name).value());
}

std::vector<int> Values(const std::string& name, const Bytes& bytes, cv::Size size,
                        int padding = 0) {
  const auto picture = UnpackAs(name, bytes, size, padding);
  if (!picture) return {};
  const cv::Mat flat = picture->reshape(1, 1);
  std::vector<int> values;
  for (int i = 0; i < flat.cols; ++i)
    values.push_back(flat.depth() == CV_8U ? flat.at<std::uint8_t>(i) : flat.at<std::uint16_t>(i));
  return values;
}

TEST(PixelFormat, BytesAndWords) {
  EXPECT_THAT(Values("Mono8", {0, 1, 254, 255}, {2, 2}), ElementsAre(0, 1, 254, 255));
  EXPECT_THAT(Values("Mono10", {0xff, 0x03, 0x01, 0x00}, {2, 1}), ElementsAre(1023, 1));
  EXPECT_THAT(Values("Mono12", {0xff, 0x0f, 0x34, 0x02}, {2, 1}), ElementsAre(4095, 0x234));
  EXPECT_THAT(Values("Mono14", {0xff, 0x3f, 0x00, 0x20}, {2, 1}), ElementsAre(16383, 8192));
  EXPECT_THAT(Values("Mono16", {0xff, 0xff, 0x34, 0x12}, {2, 1}), ElementsAre(65535, 0x1234));
  EXPECT_THAT(Values("BayerRG12", {0xff, 0x0f, 0x34, 0x02}, {2, 1}), ElementsAre(4095, 0x234));
}

// 0x3a5 = 11 1010 0101, 0x0f1 = 00 1111 0001, 0x212 = 10 0001 0010, 0x1ff = 01 1111 1111.
TEST(PixelFormat, TenBitsWithoutGaps) {
  const Bytes bytes{0xa5, 0xc7, 0x23, 0xe1, 0x7f};
  EXPECT_THAT(Values("Mono10p", bytes, {2, 2}), ElementsAre(0x3a5, 0x0f1, 0x212, 0x1ff));
  EXPECT_THAT(Values("BayerGB10p", bytes, {4, 1}), ElementsAre(0x3a5, 0x0f1, 0x212, 0x1ff));
}

TEST(PixelFormat, TwelveBitsWithoutGaps) {
  const Bytes bytes{0xbc, 0x3a, 0x12, 0xef, 0x0d};
  EXPECT_THAT(Values("Mono12p", bytes, {3, 1}), ElementsAre(0xabc, 0x123, 0xdef));
  // A row that ends within a byte: the next one begins in it.
  EXPECT_THAT(Values("Mono12p", {0xbc, 0x3a, 0x12, 0xef, 0x6d, 0x45, 0x89, 0x17, 0xf0}, {3, 2}),
              ElementsAre(0xabc, 0x123, 0xdef, 0x456, 0x789, 0xf01));
}

TEST(PixelFormat, PairsInThreeBytes) {
  EXPECT_THAT(Values("Mono12Packed", {0xab, 0x3c, 0x12, 0xde, 0x0f}, {3, 1}),
              ElementsAre(0xabc, 0x123, 0xdef));
  // Ten bits: eight high ones, and two low ones in each half.
  EXPECT_THAT(Values("Mono10Packed", {0xff, 0x13, 0x80}, {2, 1}), ElementsAre(0x3ff, 0x201));
  EXPECT_THAT(Values("BayerBG12Packed", {0xab, 0x3c, 0x12}, {2, 1}), ElementsAre(0xabc, 0x123));
}

TEST(PixelFormat, ColoursAreRedGreenBlue) {
  EXPECT_THAT(Values("RGB8", {1, 2, 3, 4, 5, 6}, {2, 1}), ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(Values("BGR8", {1, 2, 3, 4, 5, 6}, {2, 1}), ElementsAre(3, 2, 1, 6, 5, 4));
}

TEST(PixelFormat, PaddedRows) {
  EXPECT_THAT(Values("Mono8", {1, 2, 3, 0, 4, 5, 6}, {3, 2}, 1), ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(Values("Mono12p", {0xbc, 0x0a, 0xff, 0x23, 0x01}, {1, 2}, 1),
              ElementsAre(0xabc, 0x123));
  EXPECT_THAT(Values("BGR8", {1, 2, 3, 0, 0, 4, 5, 6}, {1, 2}, 2), ElementsAre(3, 2, 1, 6, 5, 4));
}

TEST(PixelFormat, WhatDoesNotFitIsRefused) {
  EXPECT_EQ(UnpackAs("Mono12p", {1, 2}, {2, 1}).error().text,
            "a picture of 2 bytes, Mono12p of 2 x 1 has 3");
  EXPECT_THAT(UnpackAs("Mono12", {0x00, 0x10}, {1, 1}).error().text,
              HasSubstr("a value of 4096 in a picture of Mono12, allowed is at most 4095"));
}

TEST(PixelFormat, EveryFormatKnowsItself) {
  for (const std::string& name : PixelFormatNames()) {
    const PixelFormat format = FindPixelFormat(name).value();
    EXPECT_EQ(format.Depth(), format.bits > 8 ? CV_16U : CV_8U) << name;
    EXPECT_EQ(format.Channels(), name == "RGB8" || name == "BGR8" ? 3 : 1) << name;
    EXPECT_EQ(format.bayer.has_value(), name.starts_with("Bayer")) << name;
    const auto bytes = static_cast<std::size_t>(format.BitsPerPixel());  // of 8 pixels
    EXPECT_TRUE(UnpackAs(name, Bytes(bytes), {8, 1})) << name;
    EXPECT_FALSE(UnpackAs(name, Bytes(bytes - 1), {8, 1})) << name;
  }
  EXPECT_EQ(FindPixelFormat("BayerGR12Packed")->code, 0x010c002au);
  EXPECT_EQ(FindPixelFormat("BayerGR12Packed")->bayer, "GRBG");
  EXPECT_EQ(FindPixelFormat("Mono14")->MaxDn(), 16383.0);
  EXPECT_FALSE(FindPixelFormat("Mono9"));
}

}  // namespace
}  // namespace turnlight::rig::aravis
