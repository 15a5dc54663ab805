// The time that the commands for single devices pass to them: of a steady clock, since the command
// began.
#pragma once

#include <chrono>

#include "rig/device.h"

namespace turnlight::app {

class DeviceClock {
 public:
  rig::DeviceTime Now() const { return std::chrono::steady_clock::now() - start_; }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

inline double ToSeconds(rig::DeviceTime time) {
  return std::chrono::duration<double>(time).count();
}
// At most 10^9 s.
inline rig::DeviceTime FromSeconds(double seconds) {
  return std::chrono::duration_cast<rig::DeviceTime>(std::chrono::duration<double>(seconds));
}

}  // namespace turnlight::app
