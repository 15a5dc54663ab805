// A rig of fake devices to examine.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "app/doctor/patient.h"
#include "tests/app/fake_devices.h"
#include "tests/app/program.h"
#include "tests/temporary_folder.h"

namespace turnlight::app {

// Of a config's text; its devices made, and what was said remembered.
struct PatientOf {
  explicit PatientOf(const std::string& text)
      : drivers(fakes.WithThem()), patient(Read(folder / "c.yaml", text), drivers) {
    patient.options.out = folder.path();
    patient.say = [this](const std::string& line) { said += line + "\n"; };
    auto made =
        MakeDevices(patient.config,
                    {patient.config.table.has_value(), patient.config.camera.has_value()}, drivers);
    if (made) patient.devices = std::move(*made);
  }
  static DeviceConfig Read(const std::string& path, const std::string& text) {
    WriteText(path, text);
    auto config = ReadDeviceConfig(path);
    EXPECT_TRUE(config) << config.error().text;
    return std::move(*config);
  }

  TemporaryFolder folder;
  FakeDevices fakes;
  Drivers drivers;
  std::string said;
  Patient patient;
};

inline constexpr char kFakeRig[] = "rig: {table: {driver: fake}, camera: {driver: fake}}\n";

}  // namespace turnlight::app
