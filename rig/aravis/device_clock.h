// A camera's clock against the host's.
//
// A camera stamps its pictures by a clock of its own, that began anywhere and runs a little fast or
// slow. What binds the two is a sample: the camera's clock, read between two instants of the
// host's. One is taken with every trigger, so that the drift between two samples never adds up.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace turnlight::rig::aravis {

using Steady = std::chrono::steady_clock;

struct ClockSample {
  std::int64_t device_ns = 0;
  Steady::time_point before, after;  // of the host, around the reading

  Steady::time_point Middle() const { return before + (after - before) / 2; }
};

// What the host's clock showed when the camera's showed device_ns; wrong by at most half the time
// that the sample took, and by the drift since.
Steady::time_point HostTime(const ClockSample& sample, std::int64_t device_ns);

// Ticks of a counter of that frequency in nanoseconds, without overflow for 200 years of them.
std::int64_t NanosecondsOfTicks(std::int64_t ticks, std::int64_t ticks_per_second);

// How fast the camera's clock runs, as a multiple of the host's, and within what it is known from
// two samples. Nothing if the host's clock stood still.
struct ClockRate {
  double value = 1.0;
  double half_width = 0.0;
};
std::optional<ClockRate> RateBetween(const ClockSample& first, const ClockSample& second);

// When a picture was exposed, as far as its stamp and the host know: it was asked for at `sent` and
// had arrived whole at `arrived`. A stamp is the begin of the exposure, or, of cameras that stamp
// its end, so late that the exposure would end after the arrival. No stamp: the exposure is put at
// its earliest.
struct ExposureSpan {
  Steady::time_point begin, end;
};
ExposureSpan SpanOfExposure(std::optional<Steady::time_point> stamp, Steady::time_point sent,
                            Steady::time_point arrived, Steady::duration exposure);

}  // namespace turnlight::rig::aravis
