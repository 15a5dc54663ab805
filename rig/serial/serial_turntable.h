// A turntable behind a controller on a serial port: gives a StageProtocol its port, its clock and a
// thread of its own.
//
// The thread talks; the calls leave a wish or read what is known, and return at once, but for the
// first Open, which waits until the controller is identified. A lost port is noticed within
// milliseconds (hang-up) or by the protocol's deadlines. From then on the thread looks for it, four
// times a second: under the same path, or under whatever path the same USB serial number has. A
// controller that comes back is identified anew and has to be homed. One that is refused for good
// (another firmware, unit or axis) stays refused.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/strict_object.h"
#include "rig/device.h"
#include "rig/driver.h"
#include "rig/serial/port_finder.h"
#include "rig/serial/serial_link.h"
#include "rig/serial/stage_protocol.h"
#include "rig/serial/winding.h"

namespace turnlight::rig::serial {

struct SerialTurntableOptions {
  std::string driver;  // grbl, for messages
  PortChoice port;
  LineSettings line;
  bool reversed = false;         // whether the controller counts clockwise, seen from above
  std::optional<Travel> limits;  // of the angle; what lies outside is never commanded
  double overshoot_deg = 3.0;    // when unwinding; 0..90
  DeviceTime open_deadline = std::chrono::seconds(12);
};

class SerialTurntable : public Turntable {
 public:
  SerialTurntable(SerialTurntableOptions options, std::unique_ptr<StageProtocol> protocol);
  // Says its last words and waits for a halt that is under way, at most three seconds.
  ~SerialTurntable() override;
  SerialTurntable(const SerialTurntable&) = delete;
  SerialTurntable& operator=(const SerialTurntable&) = delete;

  Result<DeviceIdentity> Open(DeviceTime now) override;
  Status Home(DeviceTime now) override;
  Status MoveTo(double angle_deg, DeviceTime now) override;
  Result<TableState> State(DeviceTime now) override;
  Status Halt(DeviceTime now) override;
  std::vector<std::string> TakeNotes() override;

  // As the controller told, once it was identified.
  std::optional<StageTraits> traits() const;
  // "libserialport" or "termios (pseudo-terminal)", once a port was opened; and its path.
  std::string port_in_use() const;

 private:
  class Worker;
  Status NotOpen() const;

  SerialTurntableOptions options_;
  std::unique_ptr<StageProtocol> protocol_;  // the worker's, once it is there
  std::unique_ptr<Worker> worker_;
};

// The keys that all serial tables have: port or usb_serial (one of the two), baud, speed_deg_s
// (20), acceleration_deg_s2 (100, of the plan), limits_deg ([min, max]), reversed (false),
// overshoot_deg (3).
struct SerialKeys {
  SerialTurntableOptions options;
  TableKinematics kinematics;
};
SerialKeys ReadSerialKeys(StrictObject& keys, const std::string& driver, int default_baud);

}  // namespace turnlight::rig::serial
