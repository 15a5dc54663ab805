// Proves, with a camera in a process that is killed: the error comes within a second or so, nothing
// hangs, neither a call nor the end of the program; after the camera is back it opens with its
// settings anew. A second client, of this program or another, is refused and told who holds the
// camera. Does not prove: cables.
#include "rig/aravis/camera_worker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <thread>

#include "test_camera.h"

namespace turnlight::rig::aravis {
namespace {

using namespace std::chrono_literals;
using testing::AnyOf;
using testing::HasSubstr;

const std::string kLostSerial = "W" + std::to_string(::getpid());

// What the camera's node does after a failure, until it is back.
Result<DeviceIdentity> OpenAgain(AravisCamera& camera, Steady::duration patience) {
  const Steady::time_point until = Steady::now() + patience;
  while (true) {
    const Steady::time_point begun = Steady::now();
    auto opened = camera.Open(Now());
    EXPECT_LT(Steady::now() - begun, 2s);
    if (opened || Steady::now() > until) return opened;
    std::this_thread::sleep_for(200ms);
  }
}

TEST(CameraWorker, KilledInTheMiddleAndBackAgain) {
  CameraProcess process(kLostSerial);
  AravisCamera camera(Config("Mono8"));
  const auto opened = camera.Open(Now());
  ASSERT_TRUE(opened) << opened.error().text;
  ASSERT_TRUE(camera.Set({500.0, 0.0}, Now()));
  const auto first = Shoot(camera);
  ASSERT_TRUE(first) << first.error().text;
  process.Kill();
  const Steady::time_point killed = Steady::now();
  const auto lost = Shoot(camera);
  ASSERT_FALSE(lost);
  EXPECT_LT(Steady::now() - killed, 5s);
  EXPECT_THAT(lost.error().text, AnyOf(HasSubstr("does not answer"), HasSubstr("timeout")));
  EXPECT_THAT(camera.Set({500.0, 0.0}, Now()).error().text, HasSubstr("not open"));
  EXPECT_FALSE(OpenAgain(camera, 1s));
  CameraProcess again(kLostSerial);
  const auto back = OpenAgain(camera, 20s);
  ASSERT_TRUE(back) << back.error().text;
  EXPECT_EQ(back->serial, kLostSerial);
  EXPECT_EQ(camera.Set({700.0, 0.0}, Now())->exposure_us, 700.0);
  const auto frame = Shoot(camera);
  ASSERT_TRUE(frame) << frame.error().text;
  EXPECT_GT(frame->frame_id, first->frame_id);  // though the camera began to count again
}

// An acknowledgement that comes late: the command went out twice, and what it made is not taken.
TEST(CameraWorker, ATriggerThatWasSentTwice) {
  CameraProcess process(kLostSerial);
  AravisCamera camera(Config("Mono8"));
  ASSERT_TRUE(camera.Open(Now()));
  ASSERT_TRUE(camera.Set({500.0, 0.0}, Now()));
  process.Freeze();
  const DeviceTime frozen = Now();
  std::jthread thaw([&] {
    std::this_thread::sleep_for(700ms);
    process.Thaw();
  });
  const auto frame = Shoot(camera);
  ASSERT_TRUE(frame) << frame.error().text;
  EXPECT_GT(frame->exposure_begin, frozen + 700ms);
  EXPECT_EQ(camera.Report().shots.again, 1u);
}

// Silent for longer than the heartbeat allows: the camera has let us go.
TEST(CameraWorker, ControlThatWasLostIsTakenAnew) {
  CameraProcess process(kLostSerial);
  AravisCamera camera(Config("Mono8"));
  ASSERT_TRUE(camera.Open(Now()));
  process.Freeze();
  std::this_thread::sleep_for(4s);
  process.Thaw();
  if (!Shoot(camera)) {
    const auto back = OpenAgain(camera, 20s);
    ASSERT_TRUE(back) << back.error().text;
  }
  const auto frame = Shoot(camera);
  EXPECT_TRUE(frame) << frame.error().text;
}

// Another camera answers where ours was.
TEST(CameraWorker, NotTheCameraThatItWas) {
  CameraProcess process(kLostSerial);
  AravisCamera camera(Config("Mono8"));
  ASSERT_TRUE(camera.Open(Now()));
  process.Kill();
  EXPECT_FALSE(Shoot(camera));
  CameraProcess other("OTHER" + kLostSerial);
  const Steady::time_point until = Steady::now() + 20s;
  std::string why;
  while (Steady::now() < until && why.find("it was " + kLostSerial) == std::string::npos) {
    const auto opened = camera.Open(Now());
    ASSERT_FALSE(opened);
    why = opened.error().text;
  }
  EXPECT_THAT(why, HasSubstr("it was " + kLostSerial));
}

TEST(CameraWorker, ASecondClientIsRefusedWithTheHoldersName) {
  CameraProcess process(kLostSerial);
  AravisCamera camera(Config("Mono8"));
  ASSERT_TRUE(camera.Open(Now()));
  AravisCamera second(Config("Mono8"));
  const auto refused = second.Open(Now());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kDevice);
  EXPECT_THAT(refused.error().text, HasSubstr("in use by: process " + std::to_string(::getpid())));
  EXPECT_TRUE(Shoot(camera));
}

// A client that knows nothing of our lock.
TEST(CameraWorker, AnothersControlIsSeen) {
  CameraProcess process(kLostSerial);
  Failure failure;
  const Owned<ArvCamera> other(arv_camera_new(TestAddress().c_str(), failure.out()));
  ASSERT_TRUE(other);
  AravisCamera camera(Config("Mono8"));
  const auto refused = camera.Open(Now());
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().text, HasSubstr("another client controls it"));
}

// A program that ends while its camera is dead, right after a call that failed.
TEST(CameraWorkerDeathTest, TheProgramEndsAtOnce) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const Steady::time_point begun = Steady::now();
  EXPECT_EXIT(
      {
        CameraProcess process(kLostSerial);
        auto camera = std::make_unique<AravisCamera>(Config("Mono8"));
        const bool opened = camera->Open(Now()).has_value();
        process.Kill();
        const bool shot = Shoot(*camera).has_value();
        camera.reset();
        std::exit(opened && !shot ? 0 : 1);
      },
      testing::ExitedWithCode(0), "");
  EXPECT_LT(Steady::now() - begun, 5s);  // letting go of the camera alone takes longer
}

}  // namespace
}  // namespace turnlight::rig::aravis
