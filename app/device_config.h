// A config as the commands for single devices read it (home, jog, snap, doctor): that of a run, or
// only a part of one.
//
//   rig:
//     table: {driver: grbl, port: ...}     # for home and jog
//     camera: {driver: aravis, id: ...}    # for snap
//     calibration, target, length_unit     # as of a run; the calibration is read when it is needed
//   capture: {...}                         # if it is there: exposure, gain, tolerance, deadlines
//   simulation: {...}                      # which simulated devices need
// name and graph are passed over.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "app/drivers.h"
#include "base/document.h"
#include "base/result.h"
#include "base/strict_object.h"
#include "calib/radiometry.h"
#include "rig/capture/capture_plan.h"
#include "rig/rig_calibration.h"
#include "rig/sim/simulation.h"

namespace turnlight::app {

struct DeviceConfig {
  std::string file;
  std::filesystem::path folder;              // what the files that it names are relative to
  std::shared_ptr<const Document> document;  // the sections point into it
  bool has_capture = false, has_graph = false;
  rig::CapturePlan plan;                      // the defaults without a section capture
  std::optional<StrictObject> table, camera;  // with the key driver
  std::optional<rig::sim::SimulationConfig> simulation;
};

// Fails (kInput) with file, line, key and what is allowed.
Result<DeviceConfig> ReadDeviceConfig(const std::filesystem::path& path);
// The text of a config; path is for messages and for the files that it names.
Result<DeviceConfig> ParseDeviceConfig(const std::string& text, const std::filesystem::path& path);

// The devices that the config names, made and not open.
struct Devices {
  std::optional<rig::TableDevice> table;
  std::optional<rig::CameraDevice> camera;
  std::optional<rig::sim::SimulatedWorld> world;  // which simulated devices are in
};
struct WantedDevices {
  bool table = false, camera = false;
};
// Those that are wanted must be named. Fails (kInput) like MakeRig.
Result<Devices> MakeDevices(const DeviceConfig& config, WantedDevices wanted,
                            const Drivers& drivers);

// "grbl at /dev/ttyUSB0", "aravis RIG01", "mock": a device's driver and what its keys call it.
std::string NameOfTable(const DeviceConfig& config);
std::string NameOfCamera(const DeviceConfig& config);
// A text among the keys of a section; empty if it is not there.
std::string TextOf(const std::optional<StrictObject>& section, const std::string& key);

// The calibration that rig/calibration names, if it names one. Fails (kInput).
Result<std::optional<rig::RigCalibration>> ReadCalibrationOf(const DeviceConfig& config);

// What the camera's DN mean as long as nothing is known: linear, 0 to what a full pixel reads by
// the pixel format.
calib::Radiometry NominalLevels(const rig::CameraDevice& camera);

// What the camera's DN mean: by the calibration, by the simulation, else nominal.
calib::Radiometry LevelsOf(const Devices& devices,
                           const std::optional<rig::RigCalibration>& calibration);

}  // namespace turnlight::app
