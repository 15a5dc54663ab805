// Proves: the driver's keys become a device with the promised pictures; what is missing or wrong is
// refused with its key and what is allowed.
#include "rig/aravis/aravis_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/document.h"
#include "rig/aravis/aravis_camera.h"

namespace turnlight::rig::aravis {
namespace {

using testing::HasSubstr;

Result<CameraDevice> Make(const std::string& yaml) {
  const auto document = ParseYaml(yaml, "r.yaml");
  EXPECT_TRUE(document) << document.error().text;
  return MakeAravisCamera(StrictObject(*document));
}

TEST(AravisConfig, WhatAPlanMustKnow) {
  const auto device = Make(
      "{id: SN1, pixel_format: BayerRG12p, roi: [8, 16, 640, 480], binning: [2, 2],"
      " readout_ms: 80}");
  ASSERT_TRUE(device) << device.error().text;
  EXPECT_EQ(device->format.size, cv::Size(640, 480));
  EXPECT_EQ(device->format.channels, 1);
  EXPECT_EQ(device->format.depth, CV_16U);
  EXPECT_EQ(device->bayer, "RGGB");
  EXPECT_EQ(device->roi_offset, (std::array{16, 32}));
  EXPECT_EQ(device->binning, (std::array{2, 2}));
  EXPECT_EQ(device->full_scale_dn, (std::array{2048.0, 4095.0}));
  EXPECT_DOUBLE_EQ(device->readout_s, 0.08);
  const auto colour = Make("{id: SN1, pixel_format: BGR8, size: [640, 480]}");
  ASSERT_TRUE(colour) << colour.error().text;
  EXPECT_EQ(colour->format.channels, 3);
  EXPECT_EQ(colour->format.depth, CV_8U);
  EXPECT_FALSE(colour->bayer);
}

TEST(AravisConfig, EveryKey) {
  const auto document = ParseYaml(
      "{id: a, pixel_format: Mono16, size: [64, 48], black_level: 12.5, gain_raw_step_db: 0.1,"
      " packet_size: 1500, packet_resend: false, packet_socket: true, socket_buffer_kb: 8000}",
      "r.yaml");
  const auto config = ReadAravisConfig(StrictObject(*document));
  ASSERT_TRUE(config) << config.error().text;
  EXPECT_EQ(config->black_level, 12.5);
  EXPECT_EQ(config->gain_raw_step_db, 0.1);
  EXPECT_EQ(config->packet_size, 1500);
  EXPECT_FALSE(config->packet_resend);
  EXPECT_TRUE(config->packet_socket);
  EXPECT_EQ(config->socket_buffer_kb, 8000);
}

TEST(AravisConfig, Refusals) {
  const std::pair<const char*, const char*> kCases[] = {
      {"{pixel_format: Mono8, size: [64, 48]}", "id"},
      {"{id: '', pixel_format: Mono8, size: [64, 48]}", "turnlight devices"},
      {"{id: a, size: [64, 48]}", "pixel_format"},
      {"{id: a, pixel_format: Mono9, size: [64, 48]}", "Mono10Packed"},
      {"{id: a, pixel_format: Mono8}", "either size"},
      {"{id: a, pixel_format: Mono8, size: [64, 48], roi: [0, 0, 64, 48]}", "either size"},
      {"{id: a, pixel_format: Mono8, size: [64, 0]}", "sides from 1"},
      {"{id: a, pixel_format: Mono8, size: [64, 4.5]}", "whole numbers"},
      {"{id: a, pixel_format: Mono8, roi: [-1, 0, 64, 48]}", "roi"},
      {"{id: a, pixel_format: Mono8, size: [64, 48], binning: [0, 1]}", "binning"},
      {"{id: a, pixel_format: Mono8, size: [64, 48], packet_size: 99999}", "packet_size"},
      {"{id: a, pixel_format: Mono8, size: [64, 48], colour: red}", "colour"}};
  for (const auto& [yaml, text] : kCases) {
    const auto device = Make(yaml);
    ASSERT_FALSE(device) << yaml;
    EXPECT_EQ(device.error().kind, ErrorKind::kInput) << yaml;
    EXPECT_THAT(device.error().text, HasSubstr("r.yaml")) << yaml;
    EXPECT_THAT(device.error().text, HasSubstr(text)) << yaml;
  }
}

}  // namespace
}  // namespace turnlight::rig::aravis
