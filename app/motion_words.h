// What a person types to move a table, and what the program says before it moves it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "rig/capture/capture_plan.h"

namespace turnlight::app {

// "120" and "-10" are angles, "+10" and "+-10" steps, in degrees.
struct JogTarget {
  bool step = false;
  double deg = 0.0;

  double AngleFrom(double from_deg) const { return step ? from_deg + deg : deg; }
};
// Nothing: the word is no number, or beyond a hundred turns.
std::optional<JogTarget> ParseJogTarget(const std::string& word);

// "the table NAME will turn from 20.000 to 30.000 degrees, 10 degrees counter-clockwise, at 20
// deg/s, about 0.7 s".
std::string TurnText(const std::string& table, double from_deg, double to_deg,
                     const rig::TableKinematics& kinematics);
std::string HomeText(const std::string& table);

// A command's config and its other word, in either order; the config may stand behind --config
// instead. is_other tells them apart; empty words are none.
struct DeviceWords {
  std::string config, other;
};
// other: what the other word is, for messages; empty if there is none. Fails (kInput).
Result<DeviceWords> SplitWords(const std::vector<std::string>& words, const std::string& config,
                               const std::string& other, bool (*is_other)(const std::string&));

}  // namespace turnlight::app
