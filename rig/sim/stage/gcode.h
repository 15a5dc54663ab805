// One block of G-code, as far as a turntable's GRBL understands it: read and checked before
// anything of it is done.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace turnlight::rig::sim::stage {

// The numbers of GRBL's `error:`.
enum class GrblError {
  kExpectedLetter = 1,
  kBadNumber = 2,
  kInvalidStatement = 3,
  kNegativeValue = 4,
  kHomingDisabled = 5,
  kNotIdle = 8,
  kLocked = 9,
  kSoftLimitsNeedHoming = 10,
  kLineOverflow = 11,
  kUnsupportedCommand = 20,
  kModalGroupViolation = 21,
  kUndefinedFeedRate = 22,
  kNotAnInteger = 23,
  kWordRepeated = 25,
  kValueWordMissing = 28,
  kInvalidTarget = 33,
  kUnusedWords = 36,
};

struct GcodeWord {
  char letter = 'G';
  double value = 0.0;
};

// Words in order: letters A to Z, values as 10, -3.5 or .5, no exponents.
std::variant<std::vector<GcodeWord>, GrblError> SplitGcode(const std::string& block);

// What stays from block to block.
struct GcodeModes {
  int motion = 0;  // G0, G1, or 80 for none
  bool inches = false;
  bool relative = false;
  bool inverse_time = false;  // G93
  int spindle = 5;            // M3, M4, M5
  double feed = 0.0;          // deg/min
  double spindle_speed = 0.0;
};

struct GcodeBlock {
  GcodeModes modes;               // after it
  std::optional<double> target;   // of the turning axis, deg; machine coordinates are the work's
  std::optional<double> dwell_s;  // G4
  bool spindle_changes = false;
  // Of a move: deg/min, none for G0. With G93 the move's share of a minute is in it already.
  std::optional<double> feed;
};

// axis: the letter of the turning axis; other axes of axes ("XYZ") are allowed and stand still.
// position: where the last move ends, deg.
std::variant<GcodeBlock, GrblError> ReadGcode(const std::string& block, const GcodeModes& modes,
                                              char axis, const std::string& axes, double position);

}  // namespace turnlight::rig::sim::stage
