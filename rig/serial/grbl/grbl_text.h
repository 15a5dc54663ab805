// The words of GRBL 1.1 and grblHAL, read strictly: what does not fit is no report.
// Source: the firmware's own interface documents (grbl 1.1, "Interface", "Settings", "Commands").
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace turnlight::rig::serial::grbl {

enum class State { kIdle, kRun, kHold, kJog, kAlarm, kDoor, kCheck, kHome, kSleep, kTool };

// "<Idle|MPos:1.000,0.000,0.000|FS:0,0|WCO:0.000,0.000,0.000>"; other fields are passed over.
struct StatusReport {
  State state = State::kIdle;
  std::string state_word;  // with the sub-state: "Hold:0"
  std::optional<int> substate;
  std::vector<double> position;                    // of the axes, in their units
  bool machine = true;                             // false: WPos, less the work offset
  std::optional<std::vector<double>> work_offset;  // WCO
};
std::optional<StatusReport> ParseStatus(std::string_view line);

// "Grbl 1.1h ['$' for help]", "GrblHAL 1.1f ['$' or '$HELP' for help]": the firmware with its
// version, whatever it is.
struct Banner {
  std::string firmware;  // "Grbl", "GrblHAL"
  std::string version;   // "1.1h"
};
std::optional<Banner> ParseBanner(std::string_view line);

// "[VER:1.1h.20190825:NAME]": version and the name that the user gave the board.
struct Version {
  std::string version, name;
};
std::optional<Version> ParseVersion(std::string_view line);

// "$110=7200.000", with or without an explanation in brackets after it.
struct Setting {
  int number = 0;
  std::string value;
};
std::optional<Setting> ParseSetting(std::string_view line);
using Settings = std::map<int, std::string>;
// The setting as a finite number, if it is one.
std::optional<double> SettingNumber(const Settings& settings, int number);

// "$N0=G20 G54", a line that the controller executes by itself when it starts.
struct StartupLine {
  int number = 0;
  std::string block;
};
std::optional<StartupLine> ParseStartupLine(std::string_view line);
// Whether such a block could move an axis.
bool MovesAnAxis(std::string_view block);

// "[G54:1.000,0.000,0.000]": the offsets of a coordinate system; also of G92. Others are none.
std::optional<std::vector<double>> ParseOffset(std::string_view line);

// "error:9" and "ALARM:1" (older: "ALARM: Hard limit"); the number, or 0 where words stand in its
// place.
std::optional<int> ParseError(std::string_view line);
std::optional<int> ParseAlarm(std::string_view line);
// The code with the vendor's meaning: "error:9 (locked out during alarm or jog)".
std::string ErrorWords(int code);
std::string AlarmWords(int code);

}  // namespace turnlight::rig::serial::grbl
