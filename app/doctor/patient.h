// The rig under examination: what the checks share. Each may use what an earlier one found.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/device_clock.h"
#include "app/device_config.h"
#include "base/stop_flag.h"
#include "rig/aravis/find_cameras.h"
#include "rig/device.h"

namespace turnlight::app {

struct DoctorOptions {
  std::filesystem::path out = ".";  // where runs will be written
  bool move = true;                 // whether the table may be turned
};

// A hundred pictures, one after the other.
struct FrameTrial {
  int asked = 0, good = 0, again = 0;                     // again: triggers beyond one a picture
  std::optional<double> packets_missing, packets_resent;  // if the camera counts them
  std::vector<double> seconds;  // from trigger to picture, of the good ones
  std::string error;            // of the first that did not come
};

struct Patient {
  Patient(DeviceConfig read, const Drivers& table) : config(std::move(read)), drivers(&table) {}

  const DeviceConfig config;
  const Drivers* drivers;
  DoctorOptions options;
  const StopFlag* stop = nullptr;
  DeviceClock clock;
  // What is about to happen, and what devices note meanwhile.
  std::function<void(const std::string&)> say = [](const std::string&) {};

  Devices devices;
  std::optional<rig::DeviceIdentity> table, camera;  // once they are open
  std::optional<rig::aravis::FoundCamera> found;     // the config's camera among those of Aravis
  std::optional<FrameTrial> trial;
};

inline constexpr char kNoTable[] = "the config has no rig/table";
inline constexpr char kNoCamera[] = "the config has no rig/camera";
inline constexpr char kTableShut[] = "the table could not be opened";
inline constexpr char kCameraShut[] = "the camera could not be opened";

}  // namespace turnlight::app
