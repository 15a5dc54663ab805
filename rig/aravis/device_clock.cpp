#include "rig/aravis/device_clock.h"

#include <algorithm>

namespace turnlight::rig::aravis {

Steady::time_point HostTime(const ClockSample& sample, std::int64_t device_ns) {
  return sample.Middle() + std::chrono::nanoseconds(device_ns - sample.device_ns);
}

std::int64_t NanosecondsOfTicks(std::int64_t ticks, std::int64_t ticks_per_second) {
  constexpr std::int64_t kNs = 1000000000;
  const std::int64_t seconds = ticks / ticks_per_second;
  const std::int64_t rest = ticks % ticks_per_second;
  return seconds * kNs + static_cast<std::int64_t>(static_cast<double>(rest) * 1e9 /
                                                   static_cast<double>(ticks_per_second));
}

std::optional<ClockRate> RateBetween(const ClockSample& first, const ClockSample& second) {
  using Seconds = std::chrono::duration<double>;
  const double host = Seconds(second.Middle() - first.Middle()).count();
  if (!(host > 0.0)) return std::nullopt;
  const double device = 1e-9 * static_cast<double>(second.device_ns - first.device_ns);
  const double unsure =
      0.5 * Seconds((first.after - first.before) + (second.after - second.before)).count();
  return ClockRate{device / host, unsure / host};
}

ExposureSpan SpanOfExposure(std::optional<Steady::time_point> stamp, Steady::time_point sent,
                            Steady::time_point arrived, Steady::duration exposure) {
  Steady::time_point begin = stamp.value_or(sent);
  if (begin + exposure > arrived) begin = std::max(sent, begin - exposure);
  begin = std::min(begin, arrived);
  return {begin, std::max(begin + Steady::duration(1), std::min(begin + exposure, arrived))};
}

}  // namespace turnlight::rig::aravis
