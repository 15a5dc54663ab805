// Proves that every key of the mock devices' configs is read and that wrong ones are refused by
// file, line, key and range. Does not prove that the devices obey them; their own tests do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/strict_object.h"
#include "rig/sim/mock_camera.h"
#include "rig/sim/mock_turntable.h"

namespace turnlight::rig {
namespace {

using ::testing::HasSubstr;

Result<MockTurntableConfig> ParseTable(const std::string& yaml) {
  const auto document = ParseYaml(yaml, "t.yaml");
  if (!document) return Forward(document);
  return ReadMockTurntableConfig(StrictObject(*document));
}

TEST(MockTurntableConfig, ReadsEveryKey) {
  const auto config = ParseTable(R"(
serial: T7
max_speed_deg_s: 11
acceleration_deg_s2: 12
steps_per_deg: 13
scale: -1
backlash_deg: 0.14
settle_amplitude_deg: 0.15
settle_frequency_hz: 16
settle_ms: 17
feedback: open_loop
home_switch_deg: 18
home_speed_deg_s: 19
power_on_deg: 20
)");
  ASSERT_TRUE(config) << config.error().text;
  EXPECT_EQ(config->serial, "T7");
  EXPECT_EQ(config->max_speed_deg_s, 11);
  EXPECT_EQ(config->acceleration_deg_s2, 12);
  EXPECT_EQ(config->steps_per_deg, 13);
  EXPECT_EQ(config->scale, -1);
  EXPECT_EQ(config->backlash_deg, 0.14);
  EXPECT_EQ(config->settle_amplitude_deg, 0.15);
  EXPECT_EQ(config->settle_frequency_hz, 16);
  EXPECT_EQ(config->settle_ms, 17);
  EXPECT_EQ(config->feedback, TableFeedback::kOpenLoop);
  EXPECT_EQ(config->home_switch_deg, 18);
  EXPECT_EQ(config->home_speed_deg_s, 19);
  EXPECT_EQ(config->power_on_deg, 20);
}

TEST(MockTurntableConfig, RefusesByFileLineKeyAndRange) {
  const auto refusal = [](const std::string& yaml) {
    const auto config = ParseTable(yaml);
    return config ? "accepted" : config.error().text;
  };
  EXPECT_EQ(refusal("{}"), "accepted");
  EXPECT_EQ(refusal("serial: T\nmax_speed_deg_s: 0"),
            "t.yaml:2: max_speed_deg_s: 0, allowed is a number from 0.001 to 10000");
  EXPECT_THAT(refusal("acceleration_deg_s2: -1"), HasSubstr("acceleration_deg_s2: -1, allowed"));
  EXPECT_THAT(refusal("steps_per_deg: 0"), HasSubstr("allowed is a number above 0"));
  EXPECT_THAT(refusal("scale: 0"), HasSubstr("allowed is any other number"));
  EXPECT_THAT(refusal("backlash_deg: -0.1"), HasSubstr("backlash_deg: -0.1"));
  EXPECT_THAT(refusal("settle_ms: 1e9"), HasSubstr("settle_ms"));
  EXPECT_THAT(refusal("feedback: tacho"), HasSubstr("one of open_loop, encoder"));
  EXPECT_THAT(refusal("backlash: 1"), HasSubstr("unknown key"));
  EXPECT_THAT(refusal("serial: ''"), HasSubstr("serial"));
}

TEST(MockCameraConfig, ReadsEveryKey) {
  const auto document = ParseYaml(R"(
serial: C7
scene: {seed: 9, camera: {size: [32, 24]}}
reference_exposure_us: 5000
trigger_latency_ms: 1
readout_ms: 2
blur_threshold_deg: 0.1
blur_samples: 4
first_frame_id: 77
reports_trigger: true
)",
                                  "c.yaml");
  const auto config = ReadMockCameraConfig(StrictObject(*document));
  ASSERT_TRUE(config) << config.error().text;
  EXPECT_EQ(config->serial, "C7");
  EXPECT_EQ(config->scene.seed, 9u);
  EXPECT_EQ(config->scene.camera.width, 32);
  EXPECT_EQ(config->reference_exposure_us, 5000.0);
  EXPECT_EQ(config->trigger_latency_ms, 1.0);
  EXPECT_EQ(config->readout_ms, 2.0);
  EXPECT_EQ(config->blur_threshold_deg, 0.1);
  EXPECT_EQ(config->blur_samples, 4);
  EXPECT_EQ(config->first_frame_id, 77);
  EXPECT_TRUE(config->reports_trigger);
}

TEST(MockCameraConfig, RefusesByFileLineKeyAndRange) {
  const auto refusal = [](const std::string& yaml) {
    const auto document = ParseYaml(yaml, "c.yaml");
    const auto config = ReadMockCameraConfig(StrictObject(*document));
    return config ? "accepted" : config.error().text;
  };
  EXPECT_EQ(refusal("{}"), "accepted");
  EXPECT_EQ(refusal("readout_ms: 5\nblur_samples: 1"),
            "c.yaml:2: blur_samples: 1, allowed is a number from 2 to 64");
  EXPECT_THAT(refusal("scene: {motion: {distance: 1}}"), HasSubstr("scene/motion/distance: 1"));
  EXPECT_THAT(refusal("scene: {masks: true}"), HasSubstr("scene/masks: true"));
  EXPECT_THAT(refusal("scene: {sensor: {clip_share: 0}}"), HasSubstr("scene/sensor/clip_share"));
  EXPECT_THAT(refusal("scene: {colour: red}"), HasSubstr("scene/colour: unknown key"));
  EXPECT_THAT(refusal("first_frame_id: 0"), HasSubstr("from 1 to 65535"));
  EXPECT_THAT(refusal("reference_exposure_us: 0"), HasSubstr("reference_exposure_us: 0"));
  EXPECT_THAT(refusal("fps: 30"), HasSubstr("unknown key"));
  MockCameraConfig config;
  config.blur_samples = 0;
  const auto camera =
      MockCamera::Create(config, std::make_shared<MockTurntable>(MockTurntableConfig{}));
  ASSERT_FALSE(camera);
  EXPECT_THAT(camera.error().text, HasSubstr("blur_samples: 0"));
}

}  // namespace
}  // namespace turnlight::rig
