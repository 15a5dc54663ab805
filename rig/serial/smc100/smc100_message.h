// The lines of Newport's single-axis controllers (SMC100CC, SMC100PP, CONEX-CC, CONEX-PP,
// CONEX-AGP) as values, and their codes in words.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace turnlight::rig::serial::smc100 {

struct Reply {
  int address = 0;      // 1 to 31
  std::string command;  // its two letters, upper case
  std::string value;    // what follows, without spaces around it
};

// "1TP12.5", "01ts000032", "1VE SMC100CC v3.1". Nothing if it is no such line.
std::optional<Reply> ParseReply(std::string_view line);

// The whole text as a number, spaces left out.
std::optional<double> ParseValue(std::string_view text);

// "12.50000": what PA is given, whatever the locale.
std::string FormatAngle(double angle_deg);

// What TS says.
struct ControllerState {
  unsigned errors = 0;  // bits of the positioner
  unsigned state = 0;
};

// "000032": four hexadecimal digits of errors, two of state, of either case.
std::optional<ControllerState> ParseState(std::string_view value);

enum class StateKind {
  kUnreferenced,   // 0A to 11
  kConfiguration,  // 14
  kHoming,         // 1E, 1F
  kMoving,         // 28
  kReady,          // 32 to 35
  kDisabled,       // 3C to 3F
  kOther,          // by hand, by tracking, or unknown: no state to photograph in
};

StateKind KindOf(unsigned state);
// "33, READY from MOVING".
std::string StateInWords(unsigned state);

// The errors that say no more than that a limit switch is pressed, as it may be at home.
inline constexpr unsigned kEndOfRunErrors = 0x0003;
// "following error, homing time-out"; empty if there are none.
std::string ErrorsInWords(unsigned errors);

// "G, displacement out of limits".
std::string CommandErrorInWords(char code);

// Does this stage's name say that it does not turn?
bool IsLinearStage(std::string_view name);

}  // namespace turnlight::rig::serial::smc100
