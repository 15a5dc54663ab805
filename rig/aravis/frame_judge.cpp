#include "rig/aravis/frame_judge.h"

namespace turnlight::rig::aravis {
namespace {

// 16-bit ids of GigE Vision leave 0 out.
constexpr std::uint64_t kShortIds = 65535;

}  // namespace

const char* ClockWord(ClockSource source) {
  switch (source) {
    case ClockSource::kLatch:
      return "the camera's, read with every trigger";
    case ClockSource::kHost:
      return "the host's";
    case ClockSource::kArrival:
      break;
  }
  return "none: pictures are bound by trigger and arrival";
}

bool IdAdvances(std::uint64_t id, std::uint64_t last) {
  if (id > last) return last > kShortIds || id > kShortIds || id - last < kShortIds / 2;
  return last <= kShortIds && id >= 1 && id < last && id + kShortIds - last < kShortIds / 2;
}

FrameAnswer JudgeFrame(const SentTrigger& trigger, const ArrivedFrame& frame,
                       std::optional<std::uint64_t> last_id) {
  if (!frame.complete) return FrameAnswer::kBroken;
  if (last_id && !IdAdvances(frame.id, *last_id)) return FrameAnswer::kStale;
  if (trigger.source == ClockSource::kArrival)
    return frame.arrived - trigger.sent < trigger.exposure ? FrameAnswer::kStale
                                                           : FrameAnswer::kAnswer;
  return frame.stamp_ns < trigger.clock.device_ns ? FrameAnswer::kStale : FrameAnswer::kAnswer;
}

ExposureSpan SpanOf(const SentTrigger& trigger, const ArrivedFrame& frame) {
  std::optional<Steady::time_point> stamp;
  if (trigger.source != ClockSource::kArrival) stamp = HostTime(trigger.clock, frame.stamp_ns);
  return SpanOfExposure(stamp, trigger.sent, frame.arrived, trigger.exposure);
}

std::uint64_t IdCounter::Next(std::uint64_t id) {
  if (!count_) {
    count_ = id;
  } else if (!last_id_ || !IdAdvances(id, *last_id_)) {
    ++*count_;
  } else {
    *count_ += id > *last_id_ ? id - *last_id_ : id + kShortIds - *last_id_;
  }
  last_id_ = id;
  return *count_;
}

}  // namespace turnlight::rig::aravis
