// Reads a camera's clock by its timestamp latch.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "rig/aravis/device_clock.h"
#include "rig/aravis/features.h"

namespace turnlight::rig::aravis {

class ClockReader {
 public:
  // Looks for a latch and for how many ticks a second has. device: for GigE Vision's register of
  // the tick frequency.
  void Find(Features& features, ArvDevice* device);
  bool found() const { return !command_.empty(); }
  const std::string& command() const { return command_; }

  // One reading, in ticks; the second turns ticks into nanoseconds by the frequency in use.
  Result<ClockSample> ReadTicks(Features& features);
  Result<ClockSample> Read(Features& features);

  // Which of the frequencies that the camera names lets its clock run as the host's did between two
  // readings in ticks, to within 5 %; that one is in use from now. False: none does.
  bool Calibrate(const ClockSample& first_ticks, const ClockSample& second_ticks);
  std::int64_t ticks_per_second() const { return ticks_per_second_; }

 private:
  std::string command_, value_;
  std::vector<std::int64_t> frequencies_;
  std::int64_t ticks_per_second_ = 1000000000;
};

}  // namespace turnlight::rig::aravis
