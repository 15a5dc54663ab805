// GRBL 1.1h on one turning axis in degrees: the letter X as plain GRBL has it, or A, and then it is
// a grblHAL with four axes.
//
// As a board does it: a banner after a reset and half a second of silence; real-time bytes picked
// out of the stream at any time; one line after the other, `ok` when it is accepted and not when
// the table has arrived; a planner of 15 blocks; G4 and the spindle wait for it; alarms that lock.
// Moves end at rest, blocks are not blended. Jogging, offsets, arcs, probing and the check mode are
// not there (error:20 or error:3).
//
// Its faults are the table's: kAlarm and kLimit raise ALARM:1 (kLimit with |Pn:), kReset restarts
// it, kNeverHomes ends in ALARM:9, kStuckSwitch in ALARM:8.
#pragma once

#include <array>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "rig/sim/mock_turntable.h"
#include "rig/sim/stage/gcode.h"
#include "rig/sim/stage/grbl_settings.h"
#include "rig/sim/stage/stage_firmware.h"

namespace turnlight::rig::sim::stage {

struct GrblConfig {
  char axis = 'X';                     // X, or A for a grblHAL
  std::map<int, double> settings;      // that differ from the table's and the usual
  std::string build_info;              // what `$I` shows after the version
  std::array<std::string, 2> startup;  // $N0, $N1
};

class GrblFirmware : public StageFirmware {
 public:
  GrblFirmware(GrblConfig config, std::shared_ptr<MockTurntable> table);

  void PowerOn(DeviceTime now) override;
  void Receive(std::string_view bytes, DeviceTime now) override;
  void Pass(DeviceTime now) override;

 private:
  enum class AfterAlarm { kNothing, kLock, kRestart };
  struct Move {
    double target = 0.0;  // deg, machine
    double rate = 0.0;    // deg/min
  };

  bool is_hal() const { return config_.axis == 'A'; }
  const char* axes() const { return is_hal() ? "XYZA" : "XYZ"; }
  std::size_t planner_blocks() const { return is_hal() ? 35 : 15; }
  std::size_t rx_bytes() const { return is_hal() ? 1024 : 128; }

  // grbl_firmware.cpp: the main loop, motion, alarms.
  void Restart(DeviceTime now);
  void Reset(DeviceTime now);
  void Alarm(int code, AfterAlarm after, DeviceTime now);
  void RealTime(char byte, DeviceTime now);
  void Hold(DeviceTime now);
  void Resume(DeviceTime now);
  void StepMotion(DeviceTime now);
  void StepHoming(DeviceTime now);
  void Start(const Move& move, DeviceTime now);
  void ReadLines(DeviceTime now);
  void TakeCharacter(char byte);
  void Execute(const std::string& line, DeviceTime now);
  void StepBlock(DeviceTime now);
  std::optional<GrblError> BeginBlock(const std::string& line);
  bool Plan(const Move& move, DeviceTime now);
  void RunStartupLines(DeviceTime now);
  void Answer(std::optional<GrblError> error);
  bool Moves() const { return active_ || !planner_.empty(); }
  bool IsStill(DeviceTime now) const { return !Moves() && !table_->Motor(now).moving; }

  // grbl_commands.cpp: `$` lines and reports.
  void ExecuteSystem(const std::string& line, DeviceTime now);
  std::optional<GrblError> BeginHoming(DeviceTime now);
  std::optional<GrblError> StoreSetting(const std::string& line);
  std::string BuildInfo() const;
  std::string Parameters() const;
  std::string ParserState() const;
  std::string StateWord(DeviceTime now) const;
  std::string Coordinates(double turned) const;
  void ReportStatus(DeviceTime now);

  double Position(DeviceTime now) const;  // deg, machine
  double TableDeg(double position) const;

  const GrblConfig config_;
  const std::shared_ptr<MockTurntable> table_;
  GrblSettings settings_;  // survive a reset, as what is in an EEPROM
  std::array<std::string, 2> startup_;

  std::optional<DeviceTime> boots_at_;
  std::string rx_;
  std::string line_;
  bool overflow_ = false, parentheses_ = false, comment_ = false;
  bool line_open_ = false;           // its answer is still owed
  std::optional<GcodeBlock> block_;  // of that line
  std::optional<DeviceTime> dwell_until_;

  GcodeModes modes_;
  std::deque<Move> planner_;
  std::optional<Move> active_;
  double planned_ = 0.0;  // where the planner ends, deg
  bool alarm_ = false, held_ = false, homing_ = false;
  bool soft_limit_ = false;  // comes to rest before ALARM:2
  bool locked_ = false;      // by alarm 1 or 2: nothing but a reset helps
  bool on_switch_ = false;   // for |Pn:
  DeviceTime homing_deadline_{};
  DeviceTime delay_until_{};
  AfterAlarm after_delay_ = AfterAlarm::kNothing;
  bool status_wanted_ = false;
  int wco_counter_ = 0, ov_counter_ = 0;
};

}  // namespace turnlight::rig::sim::stage
