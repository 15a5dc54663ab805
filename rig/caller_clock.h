// The clock of who calls a device, in which devices say when things were true, against the steady
// clock, in which drivers of real hardware live (device.h).
#pragma once

#include <algorithm>
#include <chrono>
#include <optional>

#include "rig/device.h"

namespace turnlight::rig {

// Not for several threads at once.
class CallerClock {
 public:
  using Steady = std::chrono::steady_clock;

  // At each call, with the caller's time. A call is always a little late, so of what is heard the
  // largest difference is the truest. One that is much smaller is of a clock that began anew, as a
  // graph's does after its devices were opened; if it was a call that was held up, the next one
  // mends it, and until then times are told too early rather than too late.
  void Hear(DeviceTime now, Steady::time_point at = Steady::now()) {
    const DeviceTime difference = now - at.time_since_epoch();
    if (!difference_ || difference > *difference_ || difference < *difference_ - kHeldUp)
      difference_ = difference;
  }
  DeviceTime ToCaller(Steady::time_point time) const {
    return time.time_since_epoch() + difference_.value_or(DeviceTime(0));
  }

 private:
  static constexpr DeviceTime kHeldUp = std::chrono::milliseconds(50);

  std::optional<DeviceTime> difference_;
};

}  // namespace turnlight::rig
