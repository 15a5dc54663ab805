// A table moved from the command line: begun, polled until it stands, and the arrival proven as
// before a picture of a capture. Every wait has a deadline; when it is over, and on Ctrl-C, the
// motor is halted.
#pragma once

#include <functional>
#include <string>

#include "app/device_clock.h"
#include "base/result.h"
#include "base/stop_flag.h"
#include "rig/device.h"

namespace turnlight::app {

// An open table and how to wait for it.
struct TableMotion {
  rig::Turntable* table = nullptr;
  const DeviceClock* clock = nullptr;
  const StopFlag* stop = nullptr;
  double tolerance_deg = 0.05;
  // At each look at it while it moves, and for each of its notes.
  std::function<void(const rig::TableState&)> watch = [](const rig::TableState&) {};
  std::function<void(const std::string&)> note = [](const std::string&) {};
};

// Each gives the state in which the table stands. Fails (kDevice) with the device's words, or where
// it stands against where it should, or that the deadline is over; (kInterrupted) on stop.

// Waits while it moves; what it then says, a lost position or a fault too, is no failure.
Result<rig::TableState> WaitUntilStill(const TableMotion& motion, rig::DeviceTime deadline);
Result<rig::TableState> HomeTable(const TableMotion& motion, rig::DeviceTime patience);
Result<rig::TableState> TurnTable(const TableMotion& motion, double angle_deg,
                                  rig::DeviceTime patience);

}  // namespace turnlight::app
