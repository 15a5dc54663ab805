// Proves: a finished session with a closure frame is judged from its files: equal views pass, a
// darker light and a turned target do not, and sessions without such a frame have no verdict.
// Does not prove what angle is seen on which scene: docs/capture.md has that, measured.
#include "rig/capture/closure_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/random.h"
#include "rig/capture/session_recorder.h"

namespace turnlight::rig {
namespace {

using testing::HasSubstr;

constexpr int kSize = 64;

// A bright square with noise, seen at some light and some place.
cv::Mat View(std::uint64_t seed, double light = 1.0, int shift = 0) {
  cv::Mat1w image(kSize, kSize);
  const RandomStream random(seed, 0);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const bool on = std::abs(x - 32 - shift) < 24 && std::abs(y - 32) < 24;
      image(y, x) = cv::saturate_cast<std::uint16_t>(
          (on ? 20000.0 * light : 0.0) +
          100.0 * random.Normal(static_cast<std::uint64_t>(kSize * y + x)));
    }
  return image;
}

class Closure : public testing::Test {
 protected:
  void SetUp() override {
    root_ = std::filesystem::path(testing::TempDir()) / "turnlight_closure" /
            testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(root_);
  }
  void TearDown() override { std::filesystem::remove_all(root_); }

  Result<std::optional<ClosureCheck>> Check(const cv::Mat& closure_view, bool closure = true,
                                            double light = 1.0) {
    CapturePlan plan;
    plan.count = 2;
    plan.step_deg = 180.0;
    plan.closure = closure;
    calib::Radiometry radiometry;
    radiometry.white = 65535.0;
    const auto camera = calib::CameraModel::FromString(
        "{ 'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [100., 100., 31.5, 31.5],\n"
        "  'extrinsics': [0., 0., 0., 0., 0., 0.], 'imagersize': [64, 64] }\n",
        "closure_check_test");
    EXPECT_TRUE(camera) << camera.error().text;
    const CaptureSetup setup{plan,
                             "config",
                             "closure",
                             "mm",
                             *camera,
                             "",
                             radiometry,
                             std::nullopt,
                             calib::SphereShape{50.0},
                             {{kSize, kSize}, 1, CV_16U},
                             {},
                             {}};
    auto recorder = SessionRecorder::Start(root_, setup, {});
    EXPECT_TRUE(recorder) << recorder.error().text;
    for (const PlannedFrame& planned : recorder->Missing()) {
      RecordedKeyframe keyframe;
      keyframe.index = planned.index;
      keyframe.image = planned.closure ? closure_view : View(planned.index, light);
      keyframe.exposure.exposure_us = 8000.0;
      const Status added = recorder->Add(keyframe);
      EXPECT_TRUE(added) << added.error().text;
    }
    const Status finished = recorder->Finish();
    EXPECT_TRUE(finished) << finished.error().text;
    return CheckClosure(root_);
  }

  std::filesystem::path root_;
};

TEST_F(Closure, EqualViewsPass) {
  const auto check = Check(View(7));
  ASSERT_TRUE(check && *check) << (check ? "no verdict" : check.error().text);
  EXPECT_TRUE((*check)->closed) << (*check)->text;
  EXPECT_EQ((*check)->first_deg, 0.0);
  EXPECT_EQ((*check)->closure_deg, 360.0);
  EXPECT_THAT((*check)->text, HasSubstr("kept its place"));
}

// A camera without noise, or two files of one picture: nothing differs at all.
TEST_F(Closure, IdenticalPicturesPass) {
  const auto check = Check(View(0));
  ASSERT_TRUE(check && *check) << (check ? "no verdict" : check.error().text);
  EXPECT_TRUE((*check)->closed) << (*check)->text;
  EXPECT_EQ((*check)->difference.block_share, 0.0);
  EXPECT_THAT((*check)->text, HasSubstr("kept its place"));
}

TEST_F(Closure, ALightThatDriftsByHalfAPercentFails) {
  const auto check = Check(View(7, 0.995));
  ASSERT_TRUE(check && *check) << (check ? "no verdict" : check.error().text);
  EXPECT_FALSE((*check)->closed) << (*check)->text;
  EXPECT_THAT((*check)->text, HasSubstr("not to be trusted"));
}

TEST_F(Closure, ATargetThatMovedByAPixelFails) {
  const auto check = Check(View(7, 1.0, 1));
  ASSERT_TRUE(check && *check) << (check ? "no verdict" : check.error().text);
  EXPECT_FALSE((*check)->closed) << (*check)->text;
}

TEST_F(Closure, PicturesWithoutALitBlockFail) {
  const auto check = Check(View(7, 0.0), true, 0.0);
  ASSERT_TRUE(check && *check) << (check ? "no verdict" : check.error().text);
  EXPECT_FALSE((*check)->closed) << (*check)->text;
  EXPECT_THAT((*check)->text, HasSubstr("too dark"));
}

TEST(CompareClosure, ClippedPicturesAreNotCalledDark) {
  calib::Radiometry radiometry;
  radiometry.white = 255.0;
  const cv::Mat clipped(64, 64, CV_8UC1, cv::Scalar(255.0));
  const ClosureCheck check = CompareClosure(0.0, clipped, 360.0, clipped, radiometry);
  EXPECT_FALSE(check.closed);
  EXPECT_THAT(check.text, testing::AllOf(HasSubstr("100 % of one is clipped; lower the exposure"),
                                         testing::Not(HasSubstr("dark"))));
}

TEST_F(Closure, WithoutAClosureFrameThereIsNoVerdict) {
  const auto check = Check({}, false);
  ASSERT_TRUE(check) << check.error().text;
  EXPECT_FALSE(*check);
}

TEST_F(Closure, ADarkClosureFrameFails) {
  const auto check = Check(View(7, 0.0));
  ASSERT_TRUE(check && *check) << (check ? "no verdict" : check.error().text);
  EXPECT_FALSE((*check)->closed) << (*check)->text;
}

TEST_F(Closure, AMissingPictureIsNamed) {
  ASSERT_TRUE(Check(View(7)));
  std::filesystem::remove(root_ / "frames/closure.png");
  const auto check = CheckClosure(root_);
  ASSERT_FALSE(check);
  EXPECT_THAT(check.error().text, HasSubstr("frames/closure.png"));
}

}  // namespace
}  // namespace turnlight::rig
