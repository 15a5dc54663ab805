// Proves: only a whole picture whose id advances and that was stamped after the trigger answers it;
// ids of 16 bits wrap, ids of 64 bits do not; one rising count comes out of both. Does not prove
// anything of a camera's own stamps.
#include "rig/aravis/frame_judge.h"

#include <gtest/gtest.h>

namespace turnlight::rig::aravis {
namespace {

using namespace std::chrono_literals;

const Steady::time_point kSent(100s);
const SentTrigger kTrigger{ClockSource::kLatch, {5000, kSent - 1ms, kSent}, kSent, 20ms};

ArrivedFrame Arrived(std::uint64_t id, std::int64_t stamp_ns) {
  return {true, id, stamp_ns, kSent + 30ms};
}

TEST(FrameJudge, TheFirstPictureAfterTheTrigger) {
  EXPECT_EQ(JudgeFrame(kTrigger, Arrived(8, 5000), 7), FrameAnswer::kAnswer);
  EXPECT_EQ(JudgeFrame(kTrigger, Arrived(8, 5000), std::nullopt), FrameAnswer::kAnswer);
  EXPECT_EQ(JudgeFrame(kTrigger, Arrived(8, 4999), 7), FrameAnswer::kStale);
  EXPECT_EQ(JudgeFrame(kTrigger, Arrived(7, 6000), 7), FrameAnswer::kStale);
  EXPECT_EQ(JudgeFrame(kTrigger, Arrived(6, 6000), 7), FrameAnswer::kStale);
  ArrivedFrame broken = Arrived(8, 6000);
  broken.complete = false;
  EXPECT_EQ(JudgeFrame(kTrigger, broken, 7), FrameAnswer::kBroken);
}

// Without a clock a picture cannot come sooner than it takes.
TEST(FrameJudge, WithoutAClockTheArrivalSpeaks) {
  SentTrigger trigger = kTrigger;
  trigger.source = ClockSource::kArrival;
  ArrivedFrame frame = Arrived(8, 0);
  EXPECT_EQ(JudgeFrame(trigger, frame, 7), FrameAnswer::kAnswer);
  frame.arrived = kSent + 19ms;
  EXPECT_EQ(JudgeFrame(trigger, frame, 7), FrameAnswer::kStale);
  EXPECT_EQ(SpanOf(trigger, Arrived(8, 0)).begin, kSent);
  EXPECT_EQ(SpanOf(trigger, Arrived(8, 0)).end, kSent + 20ms);
}

TEST(FrameJudge, TheSpanIsTheStampsInTheHostsTime) {
  const ExposureSpan span = SpanOf(kTrigger, Arrived(8, 5000 + 3000000));
  EXPECT_EQ(span.begin, kSent - 500us + 3ms);
  EXPECT_EQ(span.end, span.begin + 20ms);
}

TEST(FrameJudge, IdsWrapOrDoNot) {
  EXPECT_TRUE(IdAdvances(65535, 65534));
  EXPECT_TRUE(IdAdvances(1, 65535));
  EXPECT_TRUE(IdAdvances(3, 65530));
  EXPECT_FALSE(IdAdvances(65530, 3));  // older, from before the wrap
  EXPECT_FALSE(IdAdvances(65535, 65535));
  EXPECT_TRUE(IdAdvances(65536, 65535));
  EXPECT_TRUE(IdAdvances(1ull << 40, (1ull << 40) - 1));
  EXPECT_FALSE(IdAdvances(1, 1ull << 40));
}

TEST(FrameJudge, OneRisingCount) {
  IdCounter ids;
  EXPECT_EQ(ids.Next(65534), 65534u);
  EXPECT_EQ(ids.Next(65535), 65535u);
  EXPECT_EQ(ids.Next(1), 65536u);
  EXPECT_EQ(ids.Next(4), 65539u);
  ids.Reconnected();
  EXPECT_EQ(ids.Next(1), 65540u);
  EXPECT_EQ(ids.Next(2), 65541u);
}

}  // namespace
}  // namespace turnlight::rig::aravis
