// A Zaber rotary stage with firmware 7, one axis, on the ASCII protocol: replies with IDLE or BUSY
// and the gravest flag, checksums, message ids, alerts. Positions are microsteps, steps_per_deg of
// them to a degree.
//
// Commands: none (a poll), home, move abs|rel|min|max, stop, estop, warnings, warnings clear, get,
// set, driver enable, system reset, tools echo. Rejections: BADCOMMAND, BADDATA, BADAXIS,
// DEVICEONLY, AXISONLY, DRIVERDISABLED. Replies are never longer than one packet.
//
// Faults of the table: a stall that its encoder sees is FS, kLimit FE, kDisplaced WM, kAlarm FD for
// a second and then WR; kReset and a stuck switch leave WR. A move that another command ends is NI.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "rig/sim/mock_turntable.h"
#include "rig/sim/stage/stage_firmware.h"
#include "rig/sim/stage/zaber_message.h"

namespace turnlight::rig::sim::stage {

struct ZaberConfig {
  int device = 1;                                // its number on the chain, 1..99
  bool checksum = false;                         // whether its messages carry one from the start
  double min_deg = -36000.0, max_deg = 36000.0;  // limit.min and limit.max
};

class ZaberFirmware : public StageFirmware {
 public:
  // The table's serial must be a number.
  ZaberFirmware(ZaberConfig config, std::shared_ptr<MockTurntable> table);

  void PowerOn(DeviceTime now) override;
  void Receive(std::string_view bytes, DeviceTime now) override;
  void Pass(DeviceTime now) override;

 private:
  // What a command comes to.
  struct Outcome {
    bool accepted = true;
    std::string data = "0";
  };
  static Outcome Rejected(const char* reason) { return {false, reason}; }

  void TakeLine(const std::string& line, DeviceTime now);
  Outcome Execute(const ZaberCommand& command, DeviceTime now);
  Outcome Move(const std::vector<std::string>& words, DeviceTime now);
  Outcome Home(DeviceTime now);
  Outcome Stop(bool at_once, DeviceTime now);
  Outcome Warnings(const std::vector<std::string>& words, DeviceTime now);
  Outcome Get(const ZaberCommand& command, DeviceTime now);
  Outcome Set(const ZaberCommand& command);
  std::optional<std::string> Measured(const std::string& name, DeviceTime now) const;
  bool Preempt(DeviceTime now);  // false: the driver is off
  void EndMotion(DeviceTime now);
  std::vector<std::string> Flags(DeviceTime now) const;
  std::string Header(DeviceTime now, bool reply_accepted, bool is_reply) const;
  std::int64_t Position(DeviceTime now) const;
  bool IsBusy(DeviceTime now) const { return table_->Motor(now).moving; }
  std::string Packed(char marker, const std::string& text) const;

  const ZaberConfig config_;
  const std::shared_ptr<MockTurntable> table_;
  std::map<std::string, std::int64_t> settings_;
  std::string line_;
  std::set<std::string> flags_;  // FS, FE, WM, WR, WH, NI
  std::optional<DeviceTime> boots_at_, driver_off_until_;
  bool moving_ = false;  // a motion of its own that has not been seen to end
  bool homing_ = false;
  bool displaced_ = false;  // by hand, and seen
};

}  // namespace turnlight::rig::sim::stage
