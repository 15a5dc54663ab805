// Proves: a config with only the section that a command needs is good, what else is there is used,
// and what is missing or misspelt is refused by name; devices have a name for people; what the DN
// mean comes from calibration, simulation or pixel format. Does not prove: what drivers do with
// their keys.
#include "app/device_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/fake_devices.h"
#include "tests/app/program.h"
#include "tests/temporary_folder.h"

namespace turnlight::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class DeviceConfigTest : public testing::Test {
 protected:
  DeviceConfig Read(const std::string& text) {
    WriteText(folder_ / "c.yaml", text);
    auto config = ReadDeviceConfig(folder_ / "c.yaml");
    EXPECT_TRUE(config) << config.error().text;
    return std::move(*config);
  }
  std::string Refused(const std::string& text) {
    WriteText(folder_ / "c.yaml", text);
    const auto config = ReadDeviceConfig(folder_ / "c.yaml");
    return config ? "accepted" : config.error().text;
  }
  std::string NotMade(const std::string& text, WantedDevices wanted) {
    const DeviceConfig config = Read(text);
    const auto devices = MakeDevices(config, wanted, fakes_.WithThem());
    return devices ? "made" : devices.error().text;
  }

  const TemporaryFolder folder_;
  const FakeDevices fakes_;
};

TEST_F(DeviceConfigTest, OneSectionIsEnough) {
  const DeviceConfig table = Read("rig: {table: {driver: fake, port: /dev/ttyUSB7}}\n");
  EXPECT_EQ(NameOfTable(table), "fake at /dev/ttyUSB7");
  EXPECT_FALSE(table.has_capture);
  EXPECT_EQ(table.plan.exposures_us.front(), 8000.0);
  const auto made = MakeDevices(table, {.table = true}, fakes_.WithThem());
  ASSERT_TRUE(made) << made.error().text;
  EXPECT_TRUE(made->table && !made->camera);
  EXPECT_THAT(NotMade("rig: {table: {driver: fake}}\n", {.table = true, .camera = true}),
              HasSubstr("c.yaml: rig/camera: this key is missing, and this command needs it"));
  EXPECT_EQ(NotMade("rig: {camera: {driver: fake}}\n", {.camera = true}), "made");
  EXPECT_EQ(NameOfTable(Read("rig: {table: {driver: grbl, usb_serial: A1}}\n")),
            "grbl at the adapter A1");
}

TEST_F(DeviceConfigTest, WhatElseIsThereIsUsedAndStrict) {
  const DeviceConfig config = Read(
      "name: x\ngraph: {nodes: {}}\ncapture: {exposures_us: [123], gain_db: 6}\n"
      "rig: {table: {driver: fake}, calibration: none.json, target: {shape: cube}}\n");
  EXPECT_TRUE(config.has_capture && config.has_graph);
  EXPECT_EQ(config.plan.exposures_us.front(), 123.0);
  EXPECT_FALSE(ReadCalibrationOf(config));  // not there, and only now asked for
  EXPECT_THAT(Refused("rig: {tabel: {driver: fake}}\n"), HasSubstr("rig/tabel"));
  EXPECT_THAT(Refused("rig: {table: {driver: fake}}\ncapture: {exposures_us: [0]}\n"),
              HasSubstr("exposures_us"));
  EXPECT_THAT(Refused("table: {driver: fake}\n"), HasSubstr("rig: this key is missing"));
  EXPECT_THAT(NotMade("rig: {table: {driver: fkae}}\n", {.table = true}),
              AllOf(HasSubstr("c.yaml:1: rig/table/driver"), HasSubstr("fake")));
}

TEST_F(DeviceConfigTest, SimulatedDevicesNeedTheirWorld) {
  EXPECT_THAT(NotMade("rig: {table: {driver: mock}}\n", {.table = true}),
              HasSubstr("rig/table/driver: mock needs the section simulation"));
  const std::string world = "simulation: {target: {shape: sphere, radius: 50}}\n";
  EXPECT_THAT(NotMade("rig: {camera: {driver: mock}}\n" + world, {.camera = true}),
              HasSubstr("it photographs at the true angle of that table"));
  const DeviceConfig config =
      Read("rig: {table: {driver: mock}, camera: {driver: mock}}\n" + world);
  const auto devices = MakeDevices(config, {.camera = true}, BuiltInDrivers());
  ASSERT_TRUE(devices) << devices.error().text;
  EXPECT_EQ(LevelsOf(*devices, std::nullopt).white, 65535.0);
}

TEST_F(DeviceConfigTest, WithoutACalibrationTheFormatSaysWhatIsWhite) {
  const DeviceConfig config = Read("rig: {camera: {driver: fake}}\n");
  auto devices = MakeDevices(config, {.camera = true}, fakes_.WithThem());
  ASSERT_TRUE(devices) << devices.error().text;
  EXPECT_EQ(LevelsOf(*devices, std::nullopt).white, 255.0);
  devices->camera->full_scale_dn = {{2048.0, 4095.0}};
  EXPECT_EQ(LevelsOf(*devices, std::nullopt).white, 4095.0);
}

}  // namespace
}  // namespace turnlight::app
