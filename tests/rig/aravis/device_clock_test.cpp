// Proves: a stamp of a camera's clock becomes the host's time, whatever its offset and drift, to
// within the time that the reading took; ticks become nanoseconds without overflow; an exposure is
// never put outside trigger and arrival. Does not prove: that a camera stamps the begin of its
// exposure.
#include "rig/aravis/device_clock.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace turnlight::rig::aravis {
namespace {

using namespace std::chrono_literals;

// A camera that was switched on 3 days before the host, and runs fast by 80 parts in a million.
struct CameraClock {
  Steady::time_point zero{};
  std::int64_t At(Steady::time_point host) const {
    return 259200000000000 +
           static_cast<std::int64_t>(static_cast<double>((host - zero).count()) * 1.00008);
  }
  // Read somewhere between two looks at the host's clock.
  ClockSample Sample(Steady::time_point before, Steady::duration took, double where) const {
    const auto at = before + std::chrono::duration_cast<Steady::duration>(took * where);
    return {At(at), before, before + took};
  }
};

TEST(DeviceClock, OffsetAndDriftDoNotAddUp) {
  const CameraClock camera;
  for (int shot = 0; shot < 100; ++shot) {
    // One an hour.
    const Steady::time_point trigger{shot * 3600s};
    const ClockSample sample = camera.Sample(trigger, 2ms, shot % 2);
    const Steady::time_point exposed = trigger + 30ms;
    const auto error = HostTime(sample, camera.At(exposed)) - exposed;
    EXPECT_LE(std::abs(error.count()), Steady::duration(1ms + 10us).count());
  }
}

TEST(DeviceClock, TicksOfAnyFrequency) {
  EXPECT_EQ(NanosecondsOfTicks(125000000, 125000000), 1000000000);
  EXPECT_EQ(NanosecondsOfTicks(1, 125000000), 8);
  EXPECT_EQ(NanosecondsOfTicks(7, 1000000000), 7);
  EXPECT_EQ(NanosecondsOfTicks(66666666, 66666667), 999999985);
  // A year of ticks at 125 MHz.
  EXPECT_EQ(NanosecondsOfTicks(std::int64_t{31536000} * 125000000, 125000000),
            std::int64_t{31536000} * 1000000000);
}

TEST(DeviceClock, TheRateTellsAFrequencyThatIsWrong) {
  const CameraClock camera;
  const ClockSample first = camera.Sample(Steady::time_point(0s), 1ms, 0.0);
  const ClockSample second = camera.Sample(Steady::time_point(100ms), 1ms, 1.0);
  const auto rate = RateBetween(first, second);
  ASSERT_TRUE(rate);
  EXPECT_NEAR(rate->value, 1.01, 1e-3);
  EXPECT_NEAR(rate->half_width, 0.01, 1e-3);
  EXPECT_FALSE(RateBetween(first, first));
}

TEST(DeviceClock, AnExposureLiesBetweenTriggerAndArrival) {
  const Steady::time_point sent(10s), arrived = sent + 50ms;
  const auto span = [&](std::optional<Steady::time_point> stamp) {
    const ExposureSpan span = SpanOfExposure(stamp, sent, arrived, 20ms);
    return std::pair((span.begin - sent) / 1ms, (span.end - sent) / 1ms);
  };
  using Pair = std::pair<std::int64_t, std::int64_t>;
  EXPECT_EQ(span(sent + 5ms), Pair(5, 25));      // stamped at its begin
  EXPECT_EQ(span(sent + 45ms), Pair(25, 45));    // stamped at its end
  EXPECT_EQ(span(std::nullopt), Pair(0, 20));    // not stamped
  EXPECT_EQ(span(sent + 1000ms), Pair(50, 50));  // a clock that is wrong
  const ExposureSpan short_of = SpanOfExposure(sent, sent, sent + 1ms, 20ms);
  EXPECT_EQ(short_of.begin, sent);  // a camera faster than its exposure: a simulated one
  EXPECT_EQ(short_of.end, sent + 1ms);
}

}  // namespace
}  // namespace turnlight::rig::aravis
