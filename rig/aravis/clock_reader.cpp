#include "rig/aravis/clock_reader.h"

#include <algorithm>
#include <cmath>

namespace turnlight::rig::aravis {
namespace {

constexpr std::int64_t kNanoseconds = 1000000000;
// Above what two readings over a tenth of a second are unsure by, below any two real frequencies.
constexpr double kRateTolerance = 0.05;

}  // namespace

void ClockReader::Find(Features& features, ArvDevice* device) {
  constexpr const char* kPairs[][2] = {{"TimestampLatch", "TimestampLatchValue"},
                                       {"GevTimestampControlLatch", "GevTimestampValue"},
                                       {"TimestampControlLatch", "TimestampLatchValue"},
                                       {"TimestampControlLatch", "Timestamp"},
                                       {"TimestampLatch", "Timestamp"}};
  for (const auto& [command, value] : kPairs) {
    if (found() || !features.Has(command) || !features.Has(value)) continue;
    command_ = command;
    value_ = value;
  }
  if (!found()) return;
  for (const char* name : {"GevTimestampTickFrequency", "TimestampTickFrequency"})
    if (features.Has(name))
      if (const auto ticks = features.Integer(name); ticks && *ticks > 0)
        frequencies_.push_back(*ticks);
  if (ARV_IS_GV_DEVICE(device)) {
    Failure failure;
    const guint64 ticks =
        arv_gv_device_get_timestamp_tick_frequency(ARV_GV_DEVICE(device), failure.out());
    if (!failure && ticks > 0) frequencies_.push_back(static_cast<std::int64_t>(ticks));
  }
  frequencies_.push_back(kNanoseconds);  // the unit of SFNC since version 2
}

Result<ClockSample> ClockReader::ReadTicks(Features& features) {
  ClockSample sample;
  sample.before = Steady::now();
  if (Status latched = features.Execute(command_); !latched) return Forward(latched);
  sample.after = Steady::now();
  const auto value = features.Integer(value_);
  if (!value) return Forward(value);
  sample.device_ns = *value;
  return sample;
}

Result<ClockSample> ClockReader::Read(Features& features) {
  auto sample = ReadTicks(features);
  if (sample) sample->device_ns = NanosecondsOfTicks(sample->device_ns, ticks_per_second_);
  return sample;
}

bool ClockReader::Calibrate(const ClockSample& first_ticks, const ClockSample& second_ticks) {
  for (const std::int64_t frequency : frequencies_) {
    ClockSample first = first_ticks, second = second_ticks;
    first.device_ns = NanosecondsOfTicks(first.device_ns, frequency);
    second.device_ns = NanosecondsOfTicks(second.device_ns, frequency);
    const auto rate = RateBetween(first, second);
    if (!rate || std::abs(rate->value - 1.0) > kRateTolerance + rate->half_width) continue;
    ticks_per_second_ = frequency;
    return true;
  }
  return false;
}

}  // namespace turnlight::rig::aravis
