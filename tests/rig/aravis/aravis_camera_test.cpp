// Proves, with Aravis' simulated camera on the real protocol: every trigger has its picture, with
// the bytes that were sent, exposure and gain that the camera used, a time between trigger and
// arrival; also while packets are lost, when pictures come that nobody asked for, and with a clock
// of the camera's own. Does not prove: cameras whose stamps are wrong by their own fault; USB3
// Vision.
#include "rig/aravis/aravis_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "test_camera.h"

namespace turnlight::rig::aravis {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::HasSubstr;

double Reading(AravisCamera& camera, const std::string& name) {
  for (const DeviceReading& reading : camera.Readings())
    if (reading.name == name) return reading.value;
  return -1.0;
}

TEST(AravisCamera, APictureForATrigger) {
  FakeCamera fake(Xml(Description()), Ramp);
  AravisCamera camera(Config("Mono8"));
  const auto identity = camera.Open(Now());
  ASSERT_TRUE(identity) << identity.error().text;
  EXPECT_EQ(identity->serial, "TEST1");
  const auto set = camera.Set({1234.0, 6.0}, Now());
  ASSERT_TRUE(set) << set.error().text;
  EXPECT_EQ(set->exposure_us, 1234.0);
  EXPECT_EQ(set->gain_db, 6.0);
  std::uint64_t last_id = 0;
  for (std::uint64_t i = 1; i <= 20; ++i) {
    const DeviceTime before = Now();
    const auto frame = Shoot(camera);
    ASSERT_TRUE(frame) << frame.error().text;
    EXPECT_EQ(frame->trigger, i);
    EXPECT_GT(frame->frame_id, last_id);
    last_id = frame->frame_id;
    EXPECT_GE(frame->exposure_begin, before);
    EXPECT_GT(frame->exposure_end, frame->exposure_begin);
    EXPECT_LE(frame->exposure_end, Now());
    EXPECT_EQ(frame->actual.exposure_us, 1234.0);
    EXPECT_EQ(frame->actual.gain_db, 6.0);
    ASSERT_EQ(frame->image.size(), cv::Size(64, 48));
  }
  EXPECT_EQ(Reading(camera, "Triggers"), 21.0);  // and the first, thrown away
  EXPECT_EQ(Reading(camera, "PacketsMissing"), 0.0);
}

// Settings beyond the camera's bounds: what it has is told, and judged by others.
TEST(AravisCamera, WhatItCannotIsReadBack) {
  FakeCamera fake(Xml(Description()));
  AravisCamera camera(Config("Mono8"));
  ASSERT_TRUE(camera.Open(Now()));
  EXPECT_EQ(camera.Set({5e6, 30.0}, Now())->exposure_us, 1e6);
  EXPECT_EQ(camera.Set({5e6, 30.0}, Now())->gain_db, 24.0);
  EXPECT_FALSE(camera.Set({-1.0, 0.0}, Now()));
}

class EachFormat : public testing::TestWithParam<std::string> {};

TEST_P(EachFormat, ArrivesByteByByte) {
  const AravisConfig config = Config(GetParam());
  std::vector<std::uint8_t> sent(
      static_cast<std::size_t>(64 * 48 * config.format.BitsPerPixel() / 8));
  const bool words = config.format.layout == PixelLayout::kWords;
  for (std::size_t i = 0; i < sent.size(); ++i)  // low bytes, and high ones within the bits
    sent[i] = static_cast<std::uint8_t>(words && i % 2 == 1 ? i % (1u << (config.format.bits - 8))
                                                            : i * 7);
  FakeCamera fake(Xml(Description()), [&sent](const FakeCamera::Picture& picture) {
    std::copy_n(sent.begin(), std::min(sent.size(), picture.bytes), picture.data);
  });
  AravisCamera camera(config);
  const auto opened = camera.Open(Now());
  ASSERT_TRUE(opened) << opened.error().text;
  const auto frame = Shoot(camera);
  ASSERT_TRUE(frame) << frame.error().text;
  const auto expected = Unpack(sent, config.size, 0, config.format);
  ASSERT_TRUE(expected) << expected.error().text;
  ASSERT_EQ(frame->image.type(), expected->type());
  EXPECT_EQ(cv::norm(frame->image, *expected, cv::NORM_INF), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Formats, EachFormat,
                         testing::Values("Mono8", "Mono12", "Mono16", "Mono10p", "Mono12Packed",
                                         "BayerRG12", "BayerGB16", "BayerBG12p", "RGB8", "BGR8"),
                         [](const auto& info) { return info.param; });

TEST(AravisCamera, AHundredShotsWhileAHundredthOfThePacketsIsLost) {
  FakeCamera fake(Xml(Description()), Ramp);
  AravisConfig config = Config("Mono8");
  // 8 packets: one picture of 13 breaks, and of 400,000 shots one fails five times.
  config.size = {256, 192};
  AravisCamera camera(config);
  ASSERT_TRUE(camera.Open(Now()));
  fake.LosePackets(0.01);
  for (int i = 0; i < 100; ++i) {
    const auto frame = Shoot(camera);
    ASSERT_TRUE(frame) << i << ": " << frame.error().text;
    for (int y = 0; y < 192; y += 13) ASSERT_EQ(frame->image.at<std::uint8_t>(y, 5), 5) << i;
  }
  EXPECT_GT(Reading(camera, "PicturesBroken"), 0.0);
  EXPECT_EQ(Reading(camera, "TriggersAgain"),
            Reading(camera, "PicturesBroken") + Reading(camera, "TriggersUnanswered"));
}

// Other pictures come before the one that was asked for: of the past, by stamp or by id.
TEST(AravisCamera, StalePicturesAreNotTaken) {
  std::atomic<int> pictures = 0;
  FakeCamera fake(Xml(Description()), [&pictures](const FakeCamera::Picture& picture) {
    const int number = ++pictures;
    std::fill_n(picture.data, picture.bytes, static_cast<std::uint8_t>(number));
    if (number == 2)
      arv_buffer_set_timestamp(picture.buffer, arv_buffer_get_timestamp(picture.buffer) - 50000000);
  });
  AravisCamera camera(Config("Mono8"));
  ASSERT_TRUE(camera.Open(Now()));
  // The second picture ever seems to be older than its trigger; the third is asked for instead.
  const auto frame = Shoot(camera);
  ASSERT_TRUE(frame) << frame.error().text;
  EXPECT_EQ(frame->image.at<std::uint8_t>(0, 0), 3);
  EXPECT_EQ(Reading(camera, "PicturesStale"), 1.0);
  // What was triggered by somebody else lies in the queue.
  fake.Write(ARV_FAKE_CAMERA_REGISTER_TRIGGER_SOFTWARE, 1);
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(camera.Drain(Now()), 1);
  EXPECT_EQ(Shoot(camera)->image.at<std::uint8_t>(0, 0), 5);
}

// A counter of 125 MHz that began anywhere; its latch is a register that a thread keeps up.
class OwnClock {
 public:
  explicit OwnClock(std::int64_t ticks_per_second) : ticks_per_second_(ticks_per_second) {}
  std::int64_t Now() const {
    return 777000000000 +
           static_cast<std::int64_t>(static_cast<double>(g_get_monotonic_time()) * 1e-6 *
                                     static_cast<double>(ticks_per_second_) * 1.00005);
  }
  void Stamp(const FakeCamera::Picture& picture) const {
    Ramp(picture);
    arv_buffer_set_timestamp(picture.buffer, static_cast<guint64>(Now()));
  }

 private:
  std::int64_t ticks_per_second_;
};

void TryOwnClock(const Description& description, std::int64_t stated) {
  const OwnClock clock(125000000);
  FakeCamera fake(Xml(description), [&](const auto& picture) { clock.Stamp(picture); });
  fake.Write(0x0940, static_cast<std::uint32_t>(stated));  // the bootstrap register
  fake.Write(0x8110, static_cast<std::uint32_t>(stated));
  std::jthread latch([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      fake.WriteClock(clock.Now());
      std::this_thread::sleep_for(100us);
    }
  });
  AravisCamera camera(Config("Mono8"));
  const auto opened = camera.Open(Now());
  ASSERT_TRUE(opened) << opened.error().text;
  ASSERT_TRUE(camera.Set({200.0, 0.0}, Now()));
  EXPECT_EQ(camera.Report().clock, ClockWord(ClockSource::kLatch));
  for (int i = 0; i < 5; ++i) {
    const DeviceTime before = Now();
    const auto frame = Shoot(camera);
    ASSERT_TRUE(frame) << frame.error().text;
    EXPECT_GE(frame->exposure_begin, before);
    EXPECT_LE(frame->exposure_end, Now());
  }
}

TEST(AravisCamera, AClockOfItsOwn) {
  Description description;
  description.latch = "GevTimestampControlLatch";
  description.latch_value = "GevTimestampValue";
  description.tick_frequency = "GevTimestampTickFrequency";
  TryOwnClock(description, 125000000);
}

TEST(AravisCamera, AClockWhoseFrequencyStandsInARegisterOnly) {
  Description description;
  description.latch = "TimestampLatch";
  description.latch_value = "TimestampLatchValue";
  TryOwnClock(description, 125000000);
}

// No latch, or one that runs unlike its stamps: what is known is told, and pictures that come
// sooner than an exposure takes are not believed.
TEST(AravisCamera, WithoutAClock) {
  const OwnClock clock(1000000000);
  std::atomic<bool> hasty = false;
  FakeCamera fake(Xml(Description()), [&](const FakeCamera::Picture& picture) {
    if (!hasty) std::this_thread::sleep_for(std::chrono::microseconds(picture.exposure_us));
    clock.Stamp(picture);
  });
  AravisCamera camera(Config("Mono8"));
  ASSERT_TRUE(camera.Open(Now()));
  EXPECT_EQ(camera.Report().clock, ClockWord(ClockSource::kArrival));
  EXPECT_THAT(camera.TakeNotes(), Contains(HasSubstr("clock cannot be read")));
  ASSERT_TRUE(camera.Set({20000.0, 0.0}, Now()));
  const DeviceTime before = Now();
  const auto frame = Shoot(camera);
  ASSERT_TRUE(frame) << frame.error().text;
  EXPECT_GE(frame->exposure_begin, before);
  EXPECT_EQ(frame->exposure_end - frame->exposure_begin, 20ms);
  hasty = true;
  const auto refused = Shoot(camera);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().text, HasSubstr("sends no picture, after 3 triggers"));
}

}  // namespace
}  // namespace turnlight::rig::aravis
