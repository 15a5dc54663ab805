// Proves: a picture counts only if it answers its trigger with the settings asked for; what is
// broken is triggered again, so often and no more; a camera that says nothing has a deadline. Does
// not prove: the proofs themselves; nodes/frame_proof_test does.
#include "app/one_picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/fake_devices.h"

namespace turnlight::app {
namespace {

using testing::HasSubstr;

struct SilentCamera : FakeCamera {
  Result<std::optional<rig::RawFrame>> Poll(rig::DeviceTime) override {
    return std::optional<rig::RawFrame>();
  }
};

class OnePictureTest : public testing::Test {
 protected:
  Result<Shot> Take(FakeCamera& camera, int attempts) {
    Shooting shooting{&camera, &clock_, &stop_};
    shooting.settings = {2000.0, 3.0};
    shooting.patience = std::chrono::milliseconds(30);
    shooting.attempts = attempts;
    shooting.note = [this](const std::string& note) { notes_.push_back(note); };
    return TakePicture(shooting);
  }

  DeviceClock clock_;
  StopFlag stop_{false};
  std::vector<std::string> notes_;
};

TEST_F(OnePictureTest, BrokenOnesAreTakenAgain) {
  FakeCamera camera;
  camera.broken = 2;
  const auto shot = Take(camera, 3);
  ASSERT_TRUE(shot) << shot.error().text;
  EXPECT_EQ(shot->attempts, 3);
  EXPECT_EQ(shot->frame.actual.gain_db, 3.0);
  EXPECT_THAT(notes_, testing::Each(HasSubstr("not complete, data were lost")));
  EXPECT_EQ(notes_.size(), 2u);
  camera.broken = 2;
  const auto lost = Take(camera, 2);
  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().kind, ErrorKind::kDevice);
}

TEST_F(OnePictureTest, AnotherExposureIsNone) {
  FakeCamera camera;
  camera.exposure_factor = 1.1;
  const auto shot = Take(camera, 1);
  ASSERT_FALSE(shot);
  EXPECT_THAT(shot.error().text, HasSubstr("exposed for 2200 us, asked were 2000 us"));
}

TEST_F(OnePictureTest, SilenceEnds) {
  SilentCamera camera;
  const auto shot = Take(camera, 1);
  ASSERT_FALSE(shot);
  EXPECT_THAT(shot.error().text, HasSubstr("no picture came in answer to trigger 1 within 0.0"));
  stop_ = true;
  const auto stopped = Take(camera, 5);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::kInterrupted);
  EXPECT_EQ(camera.triggers, 2);
}

}  // namespace
}  // namespace turnlight::app
