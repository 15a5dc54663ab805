// Time on the bus: nanoseconds since the graph started, on the executor's clock (virtual, or the
// steady clock). Never wall-clock time: UTC is a label, see Clock::UtcLabel.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>

namespace turnlight::nodes::graph {

using Duration = std::chrono::nanoseconds;
using Time = std::chrono::nanoseconds;

inline constexpr Time kNever = Time::max();

inline Duration FromMs(double ms) {
  return Duration(static_cast<std::int64_t>(std::llround(ms * 1e6)));
}
inline double ToMs(Duration duration) { return static_cast<double>(duration.count()) * 1e-6; }

}  // namespace turnlight::nodes::graph
