// A conversation with a stage's controller as a pure machine: bytes in, bytes out, the passing of
// time as a number. It knows no port and no clock, so a transcript is a test and a fuzzer can talk
// to it. serial_turntable.h gives it both.
//
// How it is driven: after every call of Home, MoveTo, Halt, Leave, Receive or Pass the driver takes
// the output and writes it, and takes the events. It calls Pass at the latest when Until() is over,
// and before every Receive with the time since the last Pass.
//
// What a protocol owes:
// - It polls the status by itself, at the pace that suits its firmware, and reports each answer.
// - After MoveTo or Home was called it reports kMoving until the arrival is proven by the
// controller,
//   never an old kIdle; a command that is refused is reported as kFault with the vendor's words.
// - Moves are absolute, so a command whose answer is missing may be sent again, once; that is
// noted.
// - Every wait has a deadline; what is received is bounded, whatever comes.
// - A restart of the controller at a time when none was asked for: kUnhomed, with the reason.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "rig/device.h"

namespace turnlight::rig::serial {

// What the controller says of its stage, once identified.
struct StageTraits {
  std::optional<double> min_deg, max_deg;  // travel, inclusive; none: turns without an end
  std::optional<double> max_speed_deg_s;
  std::optional<double> acceleration_deg_s2;
  double resolution_deg = 0.0;  // of what is commanded and reported
};

// The firmware is the right one, its settings are sane, and it may be moved.
struct StageIdentified {
  DeviceIdentity identity;  // model with the firmware's version; serial may be empty
  StageTraits traits;
};

struct StageReport {
  TableMotion motion = TableMotion::kIdle;
  double position_deg = 0.0;  // as the controller reports it
  std::string fault;          // in words; empty unless kFault or kUnhomed
  DeviceTime age{};           // how long ago it was asked for: it was true at some time since then
};

// The conversation is over; nothing more is sent. for_good: another controller, unit or setting
// than this driver can work with, so that trying again is of no use.
struct StageFailed {
  std::string text;
  bool for_good = false;
};

// For the log, one line.
struct StageNote {
  std::string text;
};

using StageEvent = std::variant<StageIdentified, StageReport, StageFailed, StageNote>;

class StageProtocol {
 public:
  virtual ~StageProtocol() = default;

  // The link was just opened: everything known is forgotten, and identification begins. Nothing is
  // moved by it.
  virtual void Connect() = 0;
  // Allowed once identified. A new command replaces one that is under way.
  virtual void Home() = 0;
  virtual void MoveTo(double position_deg) = 0;
  // Stops the motor by the fastest way that keeps the position known, if there is one.
  virtual void Halt() = 0;
  // Last words before the link is closed, in any state: a lamp goes off. Sent without waiting.
  virtual void Leave() {}

  // Bytes as they came, split anywhere.
  virtual void Receive(std::string_view bytes) = 0;
  virtual void Pass(DeviceTime elapsed) = 0;
  // When Pass is due at the latest, from the last Pass on; above 0.
  virtual DeviceTime Until() const = 0;

  virtual std::string TakeOutput() = 0;
  virtual std::vector<StageEvent> TakeEvents() = 0;
};

}  // namespace turnlight::rig::serial
