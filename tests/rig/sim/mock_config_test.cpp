// Proves that every key of the mock devices and of the simulated world is read where it belongs and
// that wrong ones are refused by file, line, key and range. Does not prove that the devices obey
// them; their own tests do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/strict_object.h"
#include "rig/sim/mock_camera.h"
#include "rig/sim/mock_turntable.h"
#include "rig/sim/simulation.h"

namespace turnlight::rig::sim {
namespace {

using ::testing::HasSubstr;

// What a reader says of a text, and the config that it leaves behind.
template <typename Config>
Status Read(Status (*read)(StrictObject, Config&), const std::string& yaml, Config& config) {
  const auto document = ParseYaml(yaml, "t.yaml");
  if (!document) return Forward(document);
  return read(StrictObject(*document), config);
}
template <typename Config>
std::string Refusal(Status (*read)(StrictObject, Config&), const std::string& yaml) {
  Config config;
  const Status status = Read(read, yaml, config);
  return status ? "accepted" : status.error().text;
}

TEST(MockTurntableConfig, ReadsEveryKey) {
  MockTurntableConfig config;
  ASSERT_TRUE(Read(ReadTableDevice, R"(
serial: T7
max_speed_deg_s: 11
acceleration_deg_s2: 12
home_speed_deg_s: 19
steps_per_deg: 13
feedback: open_loop
)",
                   config));
  ASSERT_TRUE(Read(ReadTableWorld, R"(
scale: -1
backlash_deg: 0.14
settle_amplitude_deg: 0.15
settle_frequency_hz: 16
settle_ms: 17
home_switch_deg: 18
power_on_deg: 20
)",
                   config));
  EXPECT_EQ(config.serial, "T7");
  EXPECT_EQ(config.max_speed_deg_s, 11);
  EXPECT_EQ(config.acceleration_deg_s2, 12);
  EXPECT_EQ(config.home_speed_deg_s, 19);
  EXPECT_EQ(config.steps_per_deg, 13);
  EXPECT_EQ(config.feedback, TableFeedback::kOpenLoop);
  EXPECT_EQ(config.scale, -1);
  EXPECT_EQ(config.backlash_deg, 0.14);
  EXPECT_EQ(config.settle_amplitude_deg, 0.15);
  EXPECT_EQ(config.settle_frequency_hz, 16);
  EXPECT_EQ(config.settle_ms, 17);
  EXPECT_EQ(config.home_switch_deg, 18);
  EXPECT_EQ(config.power_on_deg, 20);
}

TEST(MockTurntableConfig, RefusesByFileLineKeyAndRange) {
  EXPECT_EQ(Refusal(ReadTableDevice, "{}"), "accepted");
  EXPECT_EQ(Refusal(ReadTableDevice, "serial: T\nmax_speed_deg_s: 0"),
            "t.yaml:2: max_speed_deg_s: 0, allowed is a number from 0.001 to 10000");
  EXPECT_THAT(Refusal(ReadTableDevice, "acceleration_deg_s2: -1"),
              HasSubstr("acceleration_deg_s2: -1, allowed"));
  EXPECT_THAT(Refusal(ReadTableDevice, "steps_per_deg: 0"),
              HasSubstr("allowed is a number above 0"));
  EXPECT_THAT(Refusal(ReadTableDevice, "feedback: tacho"), HasSubstr("one of open_loop, encoder"));
  EXPECT_THAT(Refusal(ReadTableDevice, "backlash_deg: 1"), HasSubstr("unknown key"));
  EXPECT_THAT(Refusal(ReadTableDevice, "serial: ''"), HasSubstr("serial"));
  EXPECT_EQ(Refusal(ReadTableWorld, "{}"), "accepted");
  EXPECT_THAT(Refusal(ReadTableWorld, "scale: 0"), HasSubstr("allowed is any other number"));
  EXPECT_THAT(Refusal(ReadTableWorld, "backlash_deg: -0.1"), HasSubstr("backlash_deg: -0.1"));
  EXPECT_THAT(Refusal(ReadTableWorld, "settle_ms: 1e9"), HasSubstr("settle_ms"));
  EXPECT_THAT(Refusal(ReadTableWorld, "max_speed_deg_s: 1"), HasSubstr("unknown key"));
}

TEST(MockCameraConfig, ReadsEveryKey) {
  MockCameraConfig config;
  ASSERT_TRUE(Read(ReadCameraDevice,
                   "{serial: C7, readout_ms: 2, first_frame_id: 77, reports_trigger: true}",
                   config));
  ASSERT_TRUE(Read(ReadShutter,
                   "{reference_exposure_us: 5000, trigger_latency_ms: 1, blur_threshold_deg: 0.1, "
                   "blur_samples: 4}",
                   config));
  EXPECT_EQ(config.serial, "C7");
  EXPECT_EQ(config.readout_ms, 2.0);
  EXPECT_EQ(config.first_frame_id, 77);
  EXPECT_TRUE(config.reports_trigger);
  EXPECT_EQ(config.reference_exposure_us, 5000.0);
  EXPECT_EQ(config.trigger_latency_ms, 1.0);
  EXPECT_EQ(config.blur_threshold_deg, 0.1);
  EXPECT_EQ(config.blur_samples, 4);
}

TEST(MockCameraConfig, RefusesByFileLineKeyAndRange) {
  EXPECT_EQ(Refusal(ReadCameraDevice, "{}"), "accepted");
  EXPECT_THAT(Refusal(ReadCameraDevice, "first_frame_id: 0"), HasSubstr("from 1 to 65535"));
  EXPECT_THAT(Refusal(ReadCameraDevice, "fps: 30"), HasSubstr("unknown key"));
  EXPECT_EQ(Refusal(ReadShutter, "{}"), "accepted");
  EXPECT_EQ(Refusal(ReadShutter, "trigger_latency_ms: 5\nblur_samples: 1"),
            "t.yaml:2: blur_samples: 1, allowed is a number from 2 to 64");
  EXPECT_THAT(Refusal(ReadShutter, "reference_exposure_us: 0"),
              HasSubstr("reference_exposure_us: 0"));
  MockCameraConfig config;
  config.blur_samples = 0;
  const auto camera =
      MockCamera::Create(config, std::make_shared<MockTurntable>(MockTurntableConfig{}));
  ASSERT_FALSE(camera);
  EXPECT_THAT(camera.error().text, HasSubstr("blur_samples: 0"));
  config = {};
  config.scene.masks = true;
  EXPECT_EQ(Validate(config)->key, "scene/masks");
}

Result<SimulationConfig> Simulation(const std::string& yaml) {
  const auto document = ParseYaml(yaml, "s.yaml");
  if (!document) return Forward(document);
  return ReadSimulation(StrictObject(*document), {0.0, 30.0, 4});
}

// A block by itself, as a simulator's whole config will be.
TEST(Simulation, ReadsTheWorldAndWhatIsInIt) {
  const auto config = Simulation(R"(
seed: 9
camera: {size: [32, 24]}
target: {shape: sphere, radius: 20}
table: {backlash_deg: 0.5}
shutter: {reference_exposure_us: 5000}
faults: {list: [{at: {keyframe: 2}, fault: stall}]}
)");
  ASSERT_TRUE(config) << config.error().text;
  EXPECT_EQ(config->camera.scene.seed, 9u);
  EXPECT_EQ(config->camera.scene.camera.width, 32);
  EXPECT_EQ(config->table.backlash_deg, 0.5);
  EXPECT_EQ(config->camera.reference_exposure_us, 5000.0);
  ASSERT_EQ(config->faults.size(), 1u);
  EXPECT_EQ(config->faults[0].angle_deg, 60.0);
}

TEST(Simulation, RefusesByFileLineKeyAndRange) {
  const auto refusal = [](const std::string& yaml) {
    const auto config = Simulation(yaml);
    return config ? "accepted" : config.error().text;
  };
  EXPECT_EQ(refusal("{}"), "accepted");
  EXPECT_THAT(refusal("seed: 1\nmotion: {distance: 1}"), HasSubstr("s.yaml:2: motion/distance: 1"));
  EXPECT_EQ(refusal("masks: true"), "s.yaml:1: masks: true, allowed is false: a camera gives none");
  EXPECT_THAT(refusal("sensor: {clip_share: 0}"), HasSubstr("sensor/clip_share"));
  EXPECT_THAT(refusal("colour: red"), HasSubstr("colour: unknown key"));
  EXPECT_THAT(refusal("shuter: {}"), HasSubstr("did you mean \"shutter\"?"));
  EXPECT_THAT(refusal("table: {max_speed_deg_s: 3}"),
              HasSubstr("table/max_speed_deg_s: unknown key"));
  EXPECT_THAT(refusal("shutter: {blur_samples: 1}"), HasSubstr("shutter/blur_samples: 1"));
  EXPECT_THAT(refusal("faults: {list: [{fault: gremlin}]}"), HasSubstr("faults/list/0/fault"));
}

}  // namespace
}  // namespace turnlight::rig::sim
