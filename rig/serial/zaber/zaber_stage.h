// Which Zaber stage this is: the settings that are asked of it, and what they say.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.h"
#include "base/strict_object.h"
#include "rig/serial/stage_protocol.h"

namespace turnlight::rig::serial::zaber {

struct ZaberOptions {
  int device = 1;  // number on the chain, 1 to 99
  int axis = 1;    // of a controller with several, 1 to 9
  // Of the stage's turn; unset: the device says it (limit.cycle.dist). A whole number above 0.
  std::optional<double> microsteps_per_turn;
};

// Reads the keys `device`, `axis` and `microsteps_per_turn`; refusals are the reader's.
ZaberOptions ReadZaberOptions(StrictObject& keys);

struct Setting {
  std::string_view name;
  bool of_device;               // asked of the device as a whole, not of the axis
  std::string_view other_name;  // that some firmware has for it; may be empty
};

inline constexpr std::array kSettings = {
    Setting{"device.id", true, "deviceid"}, Setting{"system.serial", true, ""},
    Setting{"version", true, ""},           Setting{"limit.cycle.dist", false, ""},
    Setting{"limit.min", false, ""},        Setting{"limit.max", false, ""},
    Setting{"maxspeed", false, ""},         Setting{"accel", false, "motion.accelonly"},
};

// Their values by name, as text; one that the device does not have is missing.
using SettingValues = std::map<std::string, std::string, std::less<>>;

struct ZaberStage {
  double microsteps_per_deg = 0.0;
  StageIdentified identified;
};

// Fails in words if this is no stage that turns, or not the one of the options.
Result<ZaberStage> IdentifyStage(const SettingValues& values, const ZaberOptions& options);

// A number that is all of the text.
std::optional<double> ParseNumber(std::string_view text);

}  // namespace turnlight::rig::serial::zaber
