// Proves the keys of devices/camera: defaults, ranges and messages, and what is said of the camera.
#include "rig/sim/gige/camera_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace turnlight::rig::sim::gige {
namespace {

using ::testing::HasSubstr;

Result<CameraConfig> Read(const std::string& text, const SimulationConfig& simulation = {}) {
  const auto document = ParseYaml(text, "sim.yaml");
  EXPECT_TRUE(document) << document.error().text;
  return ReadCamera(StrictObject(*document), simulation);
}

TEST(GigeCameraConfig, EveryKeyIsOptional) {
  const auto config = Read("{}");
  ASSERT_TRUE(config) << config.error().text;
  EXPECT_EQ(config->address, "127.0.0.1");
  EXPECT_EQ(config->camera.serial, "SIM-CAMERA-1");
  EXPECT_STREQ(config->format->name, "RGB8");
  EXPECT_EQ(config->packet_loss, 0.0);
}

TEST(GigeCameraConfig, ReadsWhatItIsTold) {
  const auto config = Read(
      "{address: 127.0.0.7, serial: A-1, pixel_format: Mono12Packed, packet_loss: 0.01, "
      "readout_ms: 3, first_frame_id: 65000}");
  ASSERT_TRUE(config) << config.error().text;
  EXPECT_EQ(config->address, "127.0.0.7");
  EXPECT_EQ(config->camera.serial, "A-1");
  EXPECT_STREQ(config->format->name, "Mono12Packed");
  EXPECT_EQ(config->packet_loss, 0.01);
  EXPECT_EQ(config->camera.readout_ms, 3.0);
  EXPECT_EQ(config->camera.first_frame_id, 65000);
  EXPECT_EQ(IdentityOf(*config).serial, "A-1");
}

TEST(GigeCameraConfig, RefusalsNameTheKeyAndWhatIsAllowed) {
  const std::pair<const char*, const char*> cases[] = {
      {"{address: there}", "address: \"there\", allowed is an IPv4 address"},
      {"{serial: a serial that is too long}", "serial: \"a serial that is too long\", allowed"},
      {"{pixel_format: Mono9}", "pixel_format: \"Mono9\", allowed is one of Mono8"},
      {"{packet_loss: 0.9}", "packet_loss: 0.9, allowed"},
      {"{first_frame_id: 0}", "first_frame_id: 0, allowed"},
      {"{pixelformat: Mono8}", "pixelformat"}};
  for (const auto& [text, message] : cases) {
    const auto config = Read(text);
    ASSERT_FALSE(config) << text;
    EXPECT_THAT(config.error().text, HasSubstr(message));
    EXPECT_THAT(config.error().text, HasSubstr("sim.yaml"));
  }
}

TEST(GigeCameraConfig, AnOddSensorIsRefused) {
  SimulationConfig simulation;
  simulation.camera.scene.camera.width = 321;
  const auto config = Read("{}", simulation);
  ASSERT_FALSE(config);
  EXPECT_THAT(config.error().text, HasSubstr("321 x 240, allowed are even numbers"));
}

TEST(GigeCameraConfig, WhatIsKnownIsOfTheFormatsDn) {
  SimulationConfig simulation;
  simulation.camera.scene.sensor.noise_relative = 0.002;
  const auto world = BuildWorld(simulation);
  ASSERT_TRUE(world) << world.error().text;
  const auto config = Read("{pixel_format: BayerRG12}", simulation);
  ASSERT_TRUE(config) << config.error().text;
  const RigKnowledge known = KnowledgeOf(*world, *config);
  EXPECT_EQ(known.radiometry.white, 4095.0);
  EXPECT_EQ(known.radiometry.reference_exposure_us, 8000.0);
  EXPECT_NEAR(known.noise.read_noise_dn, 8.19, 1e-9);
}

}  // namespace
}  // namespace turnlight::rig::sim::gige
