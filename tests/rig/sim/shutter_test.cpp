// Proves that settings are adjusted as stated, that a grey picture is the mean of the channels, and
// that vignetting darkens the corners and nothing else. How pictures are taken, and the faults, is
// proven through the mock camera (tests/rig/sim/mock_camera_test.cpp).
#include "rig/sim/shutter.h"

#include <gtest/gtest.h>

namespace turnlight::rig::sim {
namespace {

MockCameraConfig Plain() {
  MockCameraConfig config;
  config.scene.target = Blob{40.0, 0.3, 24};
  config.scene.motion.kind = MotionKind::kTable;
  config.scene.camera = {.width = 40, .height = 30, .focal_px = 75.0, .distortion = {}};
  config.scene.samples_per_side = 2;
  return config;
}

Shutter ShutterOf(const MockCameraConfig& config) {
  return Shutter(config, std::make_shared<const Studio>(*BuildStudio(config.scene)),
                 std::make_shared<MockTurntable>(MockTurntableConfig{}), nullptr, 1 << 20);
}

cv::Mat Picture(const MockCameraConfig& config, bool grey) {
  Shutter shutter = ShutterOf(config);
  shutter.TakeControl();
  shutter.Trigger({8000.0, 0.0}, DeviceTime(0));
  const Shot shot = shutter.Take();
  return shutter.Develop(shot, config.scene.sensor, config.scene.sensor.ToRadiometry(), grey);
}

TEST(Shutter, SettingsAreAdjusted) {
  EXPECT_EQ(Adjust({8000.4, 3.14}).exposure_us, 8000.0);
  EXPECT_DOUBLE_EQ(Adjust({8000.4, 3.14}).gain_db, 3.1);
  EXPECT_EQ(Adjust({1.0, -3.0}).exposure_us, 10.0);
  EXPECT_EQ(Adjust({1.0, -3.0}).gain_db, 0.0);
  EXPECT_EQ(Adjust({1e9, 99.0}).exposure_us, 1e7);
  EXPECT_EQ(Adjust({1e9, 99.0}).gain_db, 24.0);
}

TEST(Shutter, AGreyPictureIsTheMeanOfTheChannels) {
  const cv::Mat colour = Picture(Plain(), false), grey = Picture(Plain(), true);
  ASSERT_EQ(colour.type(), CV_16UC3);
  ASSERT_EQ(grey.type(), CV_16UC1);
  for (int i = 0; i < static_cast<int>(grey.total()); ++i) {
    const auto& pixel = colour.at<cv::Vec3w>(i);
    EXPECT_NEAR(grey.at<std::uint16_t>(i), (pixel[0] + pixel[1] + pixel[2]) / 3.0, 1.0);
  }
}

TEST(Shutter, GreyNoiseIsThatOfOneValue) {
  MockCameraConfig config = Plain();
  const cv::Mat clean = Picture(config, true);
  config.scene.sensor.noise_relative = 0.01;
  cv::Mat1d noise;
  cv::subtract(Picture(config, true), clean, noise, cv::noArray(), CV_64F);
  noise = noise(cv::Range(0, 30), cv::Range(0, 40));
  cv::Mat1b bright;  // what does not clip at 0
  cv::compare(clean, 5000, bright, cv::CMP_GT);
  cv::Scalar mean, deviation;
  cv::meanStdDev(noise, mean, deviation, bright);
  EXPECT_NEAR(deviation[0], 655.35, 65.0);
}

TEST(Shutter, VignettingDarkensTheCorners) {
  MockCameraConfig config = Plain();
  Shutter plain = ShutterOf(config);
  config.scene.camera.vignetting = 0.4;
  Shutter dark = ShutterOf(config);
  const cv::Mat3f all = plain.Render(0.0), less = dark.Render(0.0);
  const double cx = 19.5, cy = 14.5;
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) {
      const double share =
          1.0 - 0.4 * ((x - cx) * (x - cx) + (y - cy) * (y - cy)) / (cx * cx + cy * cy);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(less(y, x)[c], all(y, x)[c] * share, 1e-6);
    }
}

}  // namespace
}  // namespace turnlight::rig::sim
