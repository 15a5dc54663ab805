// Proves: pictures are planned by angle, exposure and repetition, and those that are there are kept
// if they are the planned ones and whole. Does not prove: that devices take them.
#include "app/calibrate/raw_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/file.h"
#include "base/sha256.h"
#include "rig/session/image_file.h"
#include "tests/temporary_folder.h"

namespace turnlight::app {
namespace {

using testing::HasSubstr;

rig::CapturePlan ThreeAngles() {
  rig::CapturePlan plan;
  plan.step_deg = 10.0;
  plan.count = 3;
  return plan;
}

TEST(PlanPictures, GoesByAngleThenExposureThenRepetition) {
  RawOrder order;
  const auto single = PlanPictures(ThreeAngles(), order, ".png");
  ASSERT_EQ(single.size(), 3u);
  EXPECT_EQ(single[2].image, "frames/board_002.png");
  EXPECT_EQ(single[2].angle_deg, 20.0);
  EXPECT_EQ(single[2].settings.exposure_us, 8000.0);

  order.exposures_us = {1000.0, 2000.0};
  order.pairs = 1;
  const auto pairs = PlanPictures(ThreeAngles(), order, ".tif");
  ASSERT_EQ(pairs.size(), 12u);
  EXPECT_EQ(pairs[1].settings.exposure_us, 1000.0);
  EXPECT_EQ(pairs[2].settings.exposure_us, 2000.0);
  EXPECT_EQ(pairs[4].angle_deg, 10.0);
  EXPECT_EQ(pairs[11].image, "frames/board_011.tif");

  order.move = false;
  order.count = 2;
  const auto still = PlanPictures(ThreeAngles(), order, ".png");
  EXPECT_EQ(still.size(), 8u);
  EXPECT_FALSE(still[0].angle_deg);
}

TEST(KeptFrames, AreThePlannedOnesAndWhole) {
  const TemporaryFolder folder;
  rig::RawCapture capture;
  capture.root = folder.path();
  capture.devices.resolution = {4, 3};
  std::filesystem::create_directories(folder / "frames");
  const auto plan = PlanPictures(ThreeAngles(), {}, ".png");
  for (const PlannedPicture& planned : plan) {
    ASSERT_TRUE(rig::WriteImage(capture.root / planned.image, cv::Mat(3, 4, CV_8U, 7)));
    rig::RawCaptureFrame frame;
    frame.image = planned.image;
    frame.angle_deg = planned.angle_deg;
    frame.exposure.exposure_us = 8001.0;  // as the camera rounds
    frame.sha256 = Sha256Hex(*ReadFile(capture.root / planned.image));
    capture.frames.push_back(frame);
  }
  std::filesystem::remove(capture.root / plan[1].image);
  ASSERT_TRUE(WriteFileAtomic(capture.root / plan[2].image, "torn"));
  const auto kept = KeptFrames(capture, plan);
  ASSERT_TRUE(kept) << kept.error().text;
  EXPECT_TRUE((*kept)[0] && !(*kept)[1] && !(*kept)[2]);

  capture.frames[0].exposure.exposure_us = 9000.0;
  const auto other = KeptFrames(capture, plan);
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().text,
              HasSubstr("frames/board_000.png was taken at 0 degrees, 9000 us"));
}

}  // namespace
}  // namespace turnlight::app
