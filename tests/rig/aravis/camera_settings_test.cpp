// Proves, with descriptions of our own on Aravis' simulated camera: older spellings do as well as
// standard ones; what a camera may lack is left out and told in one line; a camera that lacks what
// is needed, or that cannot be trusted, is refused with the reason. Does not prove: any maker's
// camera.
#include "rig/aravis/camera_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test_camera.h"

namespace turnlight::rig::aravis {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Field;
using testing::HasSubstr;

// Why a camera of this description does not open; empty if it does.
std::string WhyNot(const Description& description, AravisConfig config = Config("Mono8")) {
  FakeCamera fake(Xml(description));
  AravisCamera camera(std::move(config));
  const auto opened = camera.Open(Now());
  return opened ? "" : opened.error().text;
}

TEST(CameraSettings, EverythingIsAppliedAndReadBack) {
  Description description;
  description.autos = {"ExposureAuto", "GainAuto", "BalanceWhiteAuto"};
  description.switches = {"GammaEnable", "AcquisitionFrameRateEnable"};
  description.black_level = "BlackLevel";
  description.temperature = "DeviceTemperature";
  FakeCamera fake(Xml(description), Ramp);
  for (std::uint32_t address = 0x8200; address < 0x8214; address += 4) fake.Write(address, 1);
  fake.Write(0x8034, 41);
  AravisConfig config = Config("Mono16");
  config.offset = {16, 8};
  config.binning = {2, 2};
  config.black_level = 17.0;
  AravisCamera camera(config);
  const auto opened = camera.Open(Now());
  ASSERT_TRUE(opened) << opened.error().text;
  for (std::uint32_t address = 0x8200; address < 0x8214; address += 4)
    EXPECT_EQ(fake.Read(address), 0u) << address;
  EXPECT_EQ(fake.Read(ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT), 0x01100007u);
  EXPECT_EQ(fake.Read(ARV_FAKE_CAMERA_REGISTER_WIDTH), 64u);
  EXPECT_EQ(fake.Read(ARV_FAKE_CAMERA_REGISTER_X_OFFSET), 16u);
  EXPECT_EQ(fake.Read(ARV_FAKE_CAMERA_REGISTER_BINNING_VERTICAL), 2u);
  EXPECT_EQ(fake.Read(0x8030), 17u);
  const CameraReport report = camera.Report();
  const auto applied = [](const char* feature, const char* value) {
    return Contains(
        AllOf(Field(&AppliedSetting::feature, feature), Field(&AppliedSetting::value, value)));
  };
  EXPECT_THAT(report.applied, applied("PixelFormat", "Mono16"));
  EXPECT_THAT(report.applied, applied("TriggerSource", "Software"));
  EXPECT_THAT(report.applied, applied("ExposureAuto", "Off"));
  EXPECT_THAT(report.applied, applied("BlackLevel", "17"));
  EXPECT_THAT(report.readings, Contains(AllOf(Field(&DeviceReading::name, "DeviceTemperature"),
                                              Field(&DeviceReading::value, 41.0))));
  EXPECT_EQ(report.packet_size, 9000);
}

TEST(CameraSettings, OlderSpellings) {
  Description description;
  description.exposure = "ExposureTimeAbs";
  description.gain = "GainRaw";
  description.black_level = "BlackLevelRaw";
  description.switches = {"GammaEnabled", "AcquisitionFrameRateEnabled"};
  description.temperature = "TemperatureAbs";
  FakeCamera fake(Xml(description), Ramp);
  AravisConfig config = Config("Mono8");
  config.black_level = 3.0;
  config.gain_raw_step_db = 0.5;
  AravisCamera camera(config);
  const auto opened = camera.Open(Now());
  ASSERT_TRUE(opened) << opened.error().text;
  const auto set = camera.Set({777.0, 2.0}, Now());
  ASSERT_TRUE(set) << set.error().text;
  EXPECT_EQ(set->exposure_us, 777.0);
  EXPECT_EQ(set->gain_db, 2.0);
  EXPECT_EQ(fake.Read(ARV_FAKE_CAMERA_REGISTER_GAIN_RAW), 4u);
  EXPECT_EQ(fake.Read(0x8030), 3u);
  EXPECT_TRUE(Shoot(camera));
}

TEST(CameraSettings, ExposureAsAWholeNumber) {
  Description description;
  description.exposure = "ExposureTimeRaw";
  description.extra = "<Float Name=\"ExposureTimeBaseAbs\"><Value>20.0</Value></Float>\n";
  FakeCamera fake(Xml(description));
  AravisCamera camera(Config("Mono8"));
  ASSERT_TRUE(camera.Open(Now()));
  EXPECT_EQ(camera.Set({1010.0, 0.0}, Now())->exposure_us, 1020.0);  // 51 units
  EXPECT_EQ(fake.Read(ARV_FAKE_CAMERA_REGISTER_EXPOSURE_TIME_US), 51u);
}

TEST(CameraSettings, WithoutWhatIsOptional) {
  Description description;
  description.gain = "";
  description.trigger_selectors = {};
  FakeCamera fake(Xml(description), Ramp);
  AravisCamera camera(Config("Mono8"));
  const auto opened = camera.Open(Now());
  ASSERT_TRUE(opened) << opened.error().text;
  EXPECT_THAT(camera.TakeNotes(),
              testing::ElementsAre(
                  AllOf(HasSubstr("ExposureAuto"), HasSubstr("BlackLevel"), HasSubstr("Gain"))));
  EXPECT_TRUE(Shoot(camera));
  EXPECT_TRUE(camera.Set({8000.0, 0.0}, Now()));
  EXPECT_THAT(camera.Set({8000.0, 3.0}, Now()).error().text, HasSubstr("the camera has no gain"));
}

TEST(CameraSettings, AGainThatIsNotInDecibels) {
  Description description;
  description.gain = "GainRaw";
  FakeCamera fake(Xml(description));
  AravisCamera camera(Config("Mono8"));
  ASSERT_TRUE(camera.Open(Now()));
  EXPECT_THAT(camera.TakeNotes(), Contains(HasSubstr("GainRaw is not in dB")));
  EXPECT_EQ(camera.Set({8000.0, 0.0}, Now())->gain_db, 0.0);
  EXPECT_THAT(camera.Set({8000.0, 3.0}, Now()).error().text, HasSubstr("gain_raw_step_db"));
}

TEST(CameraSettings, WhatIsNeeded) {
  Description none;
  none.trigger_mode = false;
  EXPECT_THAT(WhyNot(none), HasSubstr("no software trigger"));
  none = {};
  none.trigger_command = "";
  EXPECT_THAT(WhyNot(none), HasSubstr("no software trigger"));
  none = {};
  none.exposure = "";
  EXPECT_THAT(WhyNot(none), HasSubstr("no ExposureTime"));
  none = {};
  none.trigger_sources = {"Line0", "Line1"};
  EXPECT_THAT(WhyNot(none), HasSubstr("TriggerSource: the camera has Line0, Line1"));
  none = {};
  none.trigger_selectors = {"AcquisitionStart"};
  EXPECT_THAT(WhyNot(none), HasSubstr("endless run of pictures"));
}

TEST(CameraSettings, WhatCannotBeSet) {
  Description description;
  description.autos = {"ExposureAuto"};
  description.stuck = "ExposureAuto";
  EXPECT_THAT(WhyNot(description), AllOf(HasSubstr("ExposureAuto"), HasSubstr("must be off")));
  AravisConfig config = Config("Mono8");
  config.size = {1000, 48};
  EXPECT_THAT(WhyNot({}, config),
              HasSubstr("Width: 1000 was asked for, the camera allows 8 to 640"));
  config = Config("Mono8");
  config.black_level = 4.0;
  EXPECT_THAT(WhyNot({}, config), HasSubstr("no BlackLevel"));
  FakeCamera fake("");  // Aravis' own description
  AravisCamera camera(Config("Mono12"));
  EXPECT_THAT(camera.Open(Now()).error().text,
              AllOf(HasSubstr("Mono12 was asked for, the camera has"), HasSubstr("Mono16")));
}

// The command is acknowledged, and nothing happens.
TEST(CameraSettings, ATriggerThatIsIgnored) {
  Description description;
  description.trigger_works = false;
  EXPECT_THAT(WhyNot(description),
              HasSubstr("acknowledges triggers and sends no picture, after 3 triggers"));
}

// TriggerMode reads back On, and pictures come all the same.
TEST(CameraSettings, PicturesThatNobodyTriggered) {
  Description description;
  description.trigger_mode_works = false;
  EXPECT_THAT(WhyNot(description), HasSubstr("pictures that nobody triggered"));
}

}  // namespace
}  // namespace turnlight::rig::aravis
