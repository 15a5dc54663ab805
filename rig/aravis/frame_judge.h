// Whether a picture that came answers the trigger that was sent: pure, so that every case can be
// tried without a camera.
#pragma once

#include <cstdint>
#include <optional>

#include "rig/aravis/device_clock.h"

namespace turnlight::rig::aravis {

// How a picture's time is known.
enum class ClockSource {
  kLatch,    // the camera's clock can be read: a latch command and its value
  kHost,     // the camera's stamps are the host's UTC time (PTP, or simulated on this machine)
  kArrival,  // neither: between trigger and arrival, by the host alone
};
const char* ClockWord(ClockSource source);

struct SentTrigger {
  ClockSource source = ClockSource::kArrival;
  ClockSample clock;        // just before the trigger; not used with kArrival
  Steady::time_point sent;  // before the command
  Steady::duration exposure{};
};

struct ArrivedFrame {
  bool complete = false;
  std::uint64_t id = 0;
  std::int64_t stamp_ns = 0;  // by the camera's clock
  Steady::time_point arrived;
};

enum class FrameAnswer { kAnswer, kStale, kBroken };

// Stale: its id does not advance, it was stamped before the trigger, or, without a clock, it came
// sooner after the trigger than an exposure takes. Broken: packets were lost.
FrameAnswer JudgeFrame(const SentTrigger& trigger, const ArrivedFrame& frame,
                       std::optional<std::uint64_t> last_id);

// When the picture of a trigger was exposed.
ExposureSpan SpanOf(const SentTrigger& trigger, const ArrivedFrame& frame);

// Whether id comes after last, by at most half of the ids: of 16 bits (65535 is followed by 1), or
// of 64.
bool IdAdvances(std::uint64_t id, std::uint64_t last);

// A camera's ids as one rising count over wraps and new connections. It begins with the first id.
class IdCounter {
 public:
  std::uint64_t Next(std::uint64_t id);
  void Reconnected() { last_id_.reset(); }

 private:
  std::optional<std::uint64_t> last_id_;
  std::optional<std::uint64_t> count_;
};

}  // namespace turnlight::rig::aravis
