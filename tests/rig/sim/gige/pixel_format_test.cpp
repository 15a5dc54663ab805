// Proves the bytes of each kind of format on hand-made pictures, and what their DN mean.
#include "rig/sim/gige/pixel_format.h"

#include <gtest/gtest.h>

namespace turnlight::rig::sim::gige {
namespace {

using Bytes = std::vector<std::uint8_t>;

const PixelFormat& Named(const std::string& name) { return *FindPixelFormat(name); }

TEST(PixelFormat, IsFoundByNameAndCode) {
  for (const PixelFormat& format : PixelFormats()) {
    EXPECT_EQ(FindPixelFormat(std::string(format.name)), &format);
    EXPECT_EQ(FindPixelFormat(format.code), &format);
  }
  EXPECT_EQ(FindPixelFormat(std::string("YUV422")), nullptr);
  EXPECT_EQ(FindPixelFormat(0u), nullptr);
  EXPECT_EQ(PixelFormatNames().size(), PixelFormats().size());
}

TEST(PixelFormat, TheLowerByteComesFirst) {
  const cv::Mat1w picture = (cv::Mat1w(1, 2) << 0x0123, 0x0ABC);
  EXPECT_EQ(Pack(picture, Named("Mono12"), {0, 0, 2, 1}), (Bytes{0x23, 0x01, 0xBC, 0x0A}));
  EXPECT_EQ(Pack(picture, Named("Mono16"), {0, 0, 2, 1}), (Bytes{0x23, 0x01, 0xBC, 0x0A}));
}

TEST(PixelFormat, TwoPackedValuesTakeThreeBytes) {
  const cv::Mat1w picture = (cv::Mat1w(1, 2) << 0x0123, 0x0ABC);
  EXPECT_EQ(Pack(picture, Named("Mono12Packed"), {0, 0, 2, 1}), (Bytes{0x12, 0xC3, 0xAB}));
}

TEST(PixelFormat, AMosaicKeepsOneChannelOfEachPixel) {
  cv::Mat3b picture(2, 4);
  for (int i = 0; i < 8; ++i)
    picture(i) = cv::Vec3b(static_cast<std::uint8_t>(10 * i), static_cast<std::uint8_t>(10 * i + 1),
                           static_cast<std::uint8_t>(10 * i + 2));
  EXPECT_EQ(Pack(picture, Named("BayerRG8"), {0, 0, 4, 2}), (Bytes{0, 11, 20, 31, 41, 52, 61, 72}));
  EXPECT_EQ(Pack(picture, Named("BayerRG8"), {2, 0, 2, 2}), (Bytes{20, 31, 61, 72}));
  EXPECT_EQ(Pack(picture, Named("RGB8"), {2, 1, 2, 1}), (Bytes{60, 61, 62, 70, 71, 72}));
}

TEST(PixelFormat, WhiteIsTheLargestValue) {
  const Sensor sensor;  // 16 bits
  for (const PixelFormat& format : PixelFormats()) {
    const calib::Radiometry radiometry = RadiometryOf(sensor.ToRadiometry(), sensor, format);
    EXPECT_EQ(radiometry.white, (1 << format.bits) - 1) << format.name;
    EXPECT_EQ(radiometry.SaturationDn(), radiometry.white);
    EXPECT_EQ(radiometry.black, 0.0);
  }
}

TEST(PixelFormat, BlackAndSaturationAreTheSensorsShares) {
  Sensor sensor;
  sensor.depth = SensorDepth::k8;
  sensor.black = 10.0;
  sensor.saturation = 204.0;
  const calib::Radiometry radiometry = RadiometryOf(sensor.ToRadiometry(), sensor, Named("Mono12"));
  EXPECT_EQ(radiometry.black, 161.0);  // 160.6
  EXPECT_NEAR(*radiometry.saturation, 0.8 * 4095, 1e-9);
  EXPECT_EQ(SensorOf(sensor, Named("Mono12")).depth, SensorDepth::k16);
  EXPECT_EQ(SensorOf(sensor, Named("RGB8")).depth, SensorDepth::k8);
}

}  // namespace
}  // namespace turnlight::rig::sim::gige
