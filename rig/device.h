// What a rig is made of, as the capture sees it: a camera and a turntable behind two small
// interfaces. Real drivers and simulated hardware implement the same.
//
// No call blocks for longer than it takes to hand over bytes: a move or an exposure is begun, then
// polled. Only the first Open may take longer, up to the driver's declared deadline, and a call to
// a device that has just been lost, up to a second. Time is passed in (nanoseconds since the
// capture's start, monotonic), so that simulated devices can live in virtual time; a driver of real
// hardware takes it for what its own clock shows at the call, to say in it when things were true. A
// fault is a value, never an exception, a crash or a hang.
#pragma once

#include <chrono>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"

namespace turnlight::rig {

using DeviceTime = std::chrono::nanoseconds;

// Who a device is, for the provenance.
struct DeviceIdentity {
  std::string vendor, model, serial;
};

enum class TableMotion {
  kIdle,     // standing, at angle_deg as far as the controller knows
  kMoving,   // on its way
  kUnhomed,  // position unknown (after a reset, a stall, an alarm): home before moving
  kFault,    // see fault
};

struct TableState {
  DeviceTime time{};  // when the state was true; the same as before if nothing newer is known
  TableMotion motion = TableMotion::kIdle;
  double angle_deg = 0.0;  // as the controller reports it; positive is counter-clockwise from +z
  std::string fault;       // in words; empty unless kFault or kUnhomed
};

// What a device measures of itself, for the provenance: a temperature, a counter of lost packets.
struct DeviceReading {
  std::string name;  // the device's own word, "DeviceTemperature"
  double value = 0.0;
};

class Turntable {
 public:
  virtual ~Turntable() = default;
  // Opens it and learns who it is. On a device that was lost: tries once more, without waiting.
  virtual Result<DeviceIdentity> Open(DeviceTime now) = 0;
  virtual Status Home(DeviceTime now) = 0;
  // Begins a move to an absolute angle. Refused while moving or unhomed.
  virtual Status MoveTo(double angle_deg, DeviceTime now) = 0;
  virtual Result<TableState> State(DeviceTime now) = 0;
  // Stops the motor now; the position stays known only if the controller says so.
  virtual Status Halt(DeviceTime now) = 0;
  // What happened since the last call that a person should know and the capture need not: a command
  // sent again, a setting that the device does not have. One line each.
  virtual std::vector<std::string> TakeNotes() { return {}; }
};

struct CameraSettings {
  double exposure_us = 8000.0;  // above 0
  double gain_db = 0.0;
};

// A picture as the sensor gave it, bound to its exposure.
struct RawFrame {
  cv::Mat image;               // CV_8U or CV_16U or CV_32F DN, grey or R, G, B
  std::uint64_t frame_id = 0;  // of the device; advances with every picture, may wrap at 65535
  std::uint64_t trigger = 0;   // 0 when the device does not say which trigger it answers
  DeviceTime exposure_begin{}, exposure_end{};
  CameraSettings actual;  // read back for this frame
  bool complete = true;   // false: packets were lost
};

class Camera {
 public:
  virtual ~Camera() = default;
  virtual Result<DeviceIdentity> Open(DeviceTime now) = 0;
  // Sets and reads back; the difference is the caller's to judge.
  virtual Result<CameraSettings> Set(const CameraSettings& settings, DeviceTime now) = 0;
  // Throws away what is queued, so that the next frame is a new one. Returns how many.
  virtual Result<int> Drain(DeviceTime now) = 0;
  // Begins one exposure; returns the trigger's number, counted from 1.
  virtual Result<std::uint64_t> Trigger(DeviceTime now) = 0;
  // The next frame if there is one by now.
  virtual Result<std::optional<RawFrame>> Poll(DeviceTime now) = 0;
  // As of the turntable.
  virtual std::vector<std::string> TakeNotes() { return {}; }
  // As of the last picture; empty if it measures nothing.
  virtual std::vector<DeviceReading> Readings() { return {}; }
};

}  // namespace turnlight::rig
