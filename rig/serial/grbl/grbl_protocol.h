// The conversation with GRBL 1.1 and grblHAL. Sources: the firmware's interface documents and
// sources (grbl 1.1h, grblHAL).
//
// What the firmware leaves open is closed here:
// - An `ok` says that a line was taken, not that the stage arrived. A move is `G1 X.. F..`, then
//   `G4 P0.01`, whose `ok` waits for the motion's end, then `?`: arrived is what reports Idle at
//   the target to within a step. The oks only set the pace: whichever get lost, come twice or late,
//   the report decides.
// - `?` is asked 5 times a second at most while standing, less often in motion.
// - GRBL has no feedback: it cannot see a stalled motor.
// - A restart in motion, an alarm, a banner that nobody asked for: position unknown.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/strict_object.h"
#include "rig/serial/grbl/grbl_text.h"
#include "rig/serial/line_splitter.h"
#include "rig/serial/stage_protocol.h"

namespace turnlight::rig::serial::grbl {

enum class Homing {
  kSwitch,  // $H finds the switch, and the machine's zero with it
  kHere,    // no switch: the first homing takes where the table stands for 0 degrees
};

struct GrblOptions {
  char axis = 'X';             // X, Y, Z, A, B or C: the one that counts degrees
  double speed_deg_s = 20.0;   // above 0, at most 1e4; the controller's own limit is below or above
  std::optional<Homing> home;  // none: by the switch if $22 is 1, else here
  // The spindle's or laser's output as a lamp, at this share of its full power: above 0, at most 1.
  std::optional<double> lamp_power;
};

// Reads axis (X), home (switch, here; else by $22), lamp (on, off) and lamp_power (1). The speed is
// the caller's.
GrblOptions ReadGrblOptions(StrictObject& keys);

class GrblProtocol : public StageProtocol {
 public:
  explicit GrblProtocol(const GrblOptions& options) : options_(options), lines_(kMaxLine) {}

  void Connect() override;
  void Home() override;
  void MoveTo(double position_deg) override;
  void Halt() override;
  void Leave() override;
  void Receive(std::string_view bytes) override;
  void Pass(DeviceTime elapsed) override;
  DeviceTime Until() const override;
  std::string TakeOutput() override;
  std::vector<StageEvent> TakeEvents() override;

 private:
  static constexpr std::size_t kMaxLine = 512;  // grblHAL's longest are about 200

  enum class Phase { kOff, kBanner, kResync, kIdentify, kReady };
  enum class Task { kNone, kHoming, kMoving, kHalting };
  // The line whose ok is awaited.
  enum class Sent {
    kNothing,
    kResync,
    kInfo,
    kSettings,
    kStartup,
    kOffsets,
    kLamp,
    kUnlock,
    kHome,
    kMove,
    kDwell
  };

  void OnLine(const std::string& line);
  void OnOk();
  void OnError(int code);
  void OnAlarm(int code);
  void OnBanner(const Banner& banner);
  void OnStatus(const StatusReport& status);
  void OnPush(const std::string& line);
  void OnBad(std::size_t count);

  void OnLineDeadline();
  void OnQueryUnanswered();
  void ForgetQueries();
  void Send(Sent what, const std::string& line, DeviceTime patience);
  void Query();
  void Resync();
  void Identify(Sent step);
  void AwaitStill(Sent step);
  void OnInfo();
  void OnNoIdentity();
  void Identified(const StatusReport& status);
  std::optional<std::string> Objection() const;
  Homing HowHomed() const;
  StageTraits Traits() const;
  void SoftReset(bool position_kept);
  void AfterReset();
  void BeginHoming();
  void BeginMove(double position_deg);
  void SendMove();
  void Continue();
  DeviceTime NextQueryAfter(bool late, bool again) const;
  void WatchMove(const StatusReport& status, double position);
  void WatchHalt(const StatusReport& status);
  void WatchHoming(const StatusReport& status, double position);
  void Resend();
  void Report(const StatusReport& status, double position, DeviceTime age);
  void EndTask(const std::string& fault);
  void Fail(std::string text, bool for_good);
  void Note(std::string text) { events_.push_back(StageNote{std::move(text)}); }
  void LightLamp();
  std::optional<double> Position(const StatusReport& status) const;
  bool AtTarget(double position) const;
  int AxisIndex() const;
  double StepDeg() const;

  GrblOptions options_;
  LineSplitter lines_;
  std::string output_;
  std::vector<StageEvent> events_;
  DeviceTime now_{};  // the sum of all Pass

  Phase phase_ = Phase::kOff;
  int attempts_ = 0;           // of the resynchronisation, or of a reset
  std::size_t bad_lines_ = 0;  // in a row
  Sent sent_ = Sent::kNothing;
  std::optional<DeviceTime> line_deadline_;  // of the line's answer, or of a banner
  std::optional<DeviceTime> query_sent_;     // of the last `?`, until it is answered
  DeviceTime asked_at_{};                    // of the first `?` without an answer
  bool query_again_ = false;
  std::optional<DeviceTime> next_query_;
  int missed_ = 0;  // queries in a row
  bool reset_expected_ = false;
  bool home_after_reset_ = false;

  // Learned.
  Banner banner_;
  Version version_;
  std::string options_text_;  // of [OPT:...]
  Settings settings_;
  std::vector<std::string> strange_;  // first lines of a firmware that is no GRBL
  std::optional<std::string> refused_startup_;
  std::optional<std::vector<double>> work_offset_;
  bool offset_in_use_ = false;
  bool identified_ = false;

  Task task_ = Task::kNone;
  double target_deg_ = 0.0;
  bool resent_ = false;
  int still_ = 0;  // reports in a row of a table that stands, in a move
  bool ok_missing_ = false;
  std::optional<double> pending_move_;  // until the line before it is answered
  bool pending_home_ = false;
  double zero_deg_ = 0.0;  // of Homing::kHere
  bool here_taken_ = false;
  State state_ = State::kIdle;
  int alarm_ = -1;  // the last, until a reset or a homing; -1: none
  std::string unhomed_, fault_;
};

}  // namespace turnlight::rig::serial::grbl
