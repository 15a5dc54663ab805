// The pieces that the mock turntable's motion is made of; for its own sources.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "rig/sim/mock_turntable.h"

namespace turnlight::rig::sim {

inline double Seconds(DeviceTime time) { return static_cast<double>(time.count()) * 1e-9; }

// One nanosecond more than needed, so that at the end the profile is over whatever was rounded.
inline DeviceTime RoundUp(double seconds) {
  if (seconds <= 0.0) return DeviceTime(0);
  return DeviceTime(static_cast<std::int64_t>(std::ceil(seconds * 1e9)) + 1);
}

// From one rest to the next: a move, a homing, or no motion at all. Steps count from the angle 0 of
// the controller; true degrees are the platter's.
struct MockTurntable::Segment {
  DeviceTime begin{};
  DeviceTime end{};  // the controller is no longer busy
  TableMotion outcome = TableMotion::kIdle;
  std::string fault;  // of the outcome

  TrapezoidalProfile profile{0.0, 1.0, 1.0};  // counted degrees
  double direction = 1.0;                     // of the count
  DeviceTime pause{};                         // hangs so long, half-way
  bool homing = false;
  std::int64_t count_from = 0;  // steps
  std::int64_t motor_from = 0;
  std::int64_t count_steps = 0;  // how far it counts and how far the motor gets, >= 0
  std::int64_t motor_steps = 0;
  double motor_from_deg = 0.0;  // true, as if the backlash were taken up
  double motor_to_deg = 0.0;
  double platter_from_deg = 0.0;
  double scale = 1.0;

  // Of a braking: it begins in the middle of the profile.
  double lead_s = 0.0;
  double lead_deg = 0.0;

  std::optional<FaultKind> stopped_by;  // what ended it before its target
  double commanded_deg = 0.0;
  double report_error_deg = 0.0;

  std::int64_t CountTo() const {
    return count_from + (direction < 0.0 ? -count_steps : count_steps);
  }
  std::int64_t MotorTo() const {
    return motor_from + (direction < 0.0 ? -motor_steps : motor_steps);
  }
  DeviceTime HalfTime() const { return RoundUp(0.5 * profile.Duration()); }
  // Counted degrees that an unhindered motor would have covered.
  double Covered(DeviceTime time) const {
    DeviceTime elapsed = time - begin;
    const DeviceTime half = HalfTime();
    if (elapsed > half) elapsed = std::max(half, elapsed - pause);
    return profile.At(Seconds(elapsed) + lead_s) - lead_deg;
  }
  double MotorDeg(DeviceTime time) const {
    if (time <= begin) return motor_from_deg;
    if (time >= end) return motor_to_deg;
    const double there = motor_from_deg + scale * direction * Covered(time);
    return (motor_to_deg - there) * scale * direction > 0.0 ? there : motor_to_deg;
  }
  // The motor pushes the platter from behind or, after a reversal and the backlash, from ahead. One
  // segment goes one way only, so its start and now tell all.
  double PlatterDeg(DeviceTime time, double backlash_deg) const {
    const double motor = MotorDeg(time);
    return std::max(motor, std::min(platter_from_deg, motor + backlash_deg));
  }
};

}  // namespace turnlight::rig::sim
