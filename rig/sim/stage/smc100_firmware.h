// A Newport SMC100 (CONEX-CC alike) with a rotary stage: `nnAAxx`, positions in degrees. Commands
// that set something say nothing; a bad one leaves a letter that TE tells once. OR is for a stage
// that is not referenced: RS comes first to home again. A line takes about 10 ms; a sender that
// does not wait is held off by XOFF.
//
// Commands: AC, ID, MM, OR, OT, PA, PR, RS, SL, SR, ST, TB, TE, TH, TP, TS, VA, VE.
//
// Faults of the table: a stall that its encoder sees is a following error (0020) and DISABLE from
// MOVING (3D), kAlarm an RMS current limit (0008) and 3D, kLimit an end of run (0001, 0002) and
// NOT REFERENCED from MOVING (0F), kReset NOT REFERENCED from reset (0A), kNeverHomes a homing
// time-out (0040) and 0B, kStuckSwitch an end of run and 0B.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "rig/sim/mock_turntable.h"
#include "rig/sim/stage/stage_firmware.h"

namespace turnlight::rig::sim::stage {

struct Smc100Config {
  int address = 1;                           // 1..31
  double min_deg = -360.0, max_deg = 360.0;  // SL and SR
};

class Smc100Firmware : public StageFirmware {
 public:
  Smc100Firmware(Smc100Config config, std::shared_ptr<MockTurntable> table);

  void PowerOn(DeviceTime now) override;
  void Receive(std::string_view bytes, DeviceTime now) override;
  void Pass(DeviceTime now) override;

 private:
  // The two digits of TS.
  enum class State {
    kNotReferencedFromReset = 0x0A,
    kNotReferencedFromHoming = 0x0B,
    kNotReferencedFromMoving = 0x0F,
    kHoming = 0x1E,
    kMoving = 0x28,
    kReadyFromHoming = 0x32,
    kReadyFromMoving = 0x33,
    kReadyFromDisable = 0x34,
    kDisableFromReady = 0x3C,
    kDisableFromMoving = 0x3D,
  };
  bool IsReady() const;
  bool IsNotReferenced() const;
  bool IsDisabled() const;
  // The letter of a command that this state forbids.
  char LetterOfState() const;

  void TakeLine(const std::string& line, DeviceTime now);
  void Execute(const std::string& name, const std::string& value, DeviceTime now);
  std::optional<std::string> Asked(const std::string& name, const std::string& value,
                                   DeviceTime now);
  void Command(const std::string& name, const std::string& value, DeviceTime now);
  void Move(double to_deg, DeviceTime now);
  void BeginHoming(DeviceTime now);
  void Stop(DeviceTime now);
  void SetMotor(const std::string& value, DeviceTime now);
  void StepMotion(DeviceTime now);
  void StepHoming(DeviceTime now);
  double* Parameter(const std::string& name);
  void Answer(MessageKind kind, const std::string& name, const std::string& value);

  const Smc100Config config_;
  const std::shared_ptr<MockTurntable> table_;
  double velocity_, acceleration_, min_deg_, max_deg_;
  double home_timeout_s_ = 120.0;
  State state_ = State::kNotReferencedFromReset;
  int errors_ = 0;    // the four digits of TS
  char error_ = '@';  // TE
  double setpoint_deg_ = 0.0;
  std::string rx_;
  bool held_off_ = false;  // XOFF was sent
  std::optional<DeviceTime> boots_at_;
  DeviceTime free_at_{};  // the next line is looked at
  DeviceTime home_deadline_{};
  bool upwards_ = true;
  bool stopped_ = false;  // by ST, in this move
};

}  // namespace turnlight::rig::sim::stage
