// Proves the measures of a picture against a model by closed forms, and that frames can be left out
// of observations. What fits lead to: odd_frames_test.
#include "estimator/consistency/frame_residuals.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/estimator/consistency/mangled.h"

namespace turnlight::estimator::consistency {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

cv::Mat1f Model() {
  cv::Mat1f out(10, 11);
  for (int i = 0; i < 110; ++i) out(i / 11, i % 11) = i < 10 ? kNothing : 0.1f + 0.002f * i;
  return out;
}

TEST(FrameResidual, IsNothingOfAPictureLikeTheModel) {
  const FrameResidual same = Compare(Model(), Model());
  EXPECT_EQ(same.pixels, 100u);
  EXPECT_DOUBLE_EQ(same.gain, 1.0);
  EXPECT_EQ(same.left, 0.0);
}

TEST(FrameResidual, AllowsALampToBeALittleOff) {
  const FrameResidual brighter = Compare(1.2f * Model(), Model());
  EXPECT_NEAR(brighter.gain, 1.2, 1e-6);
  EXPECT_LT(brighter.left, 1e-6);
  const FrameResidual half = Compare(0.5f * Model(), Model());
  EXPECT_NEAR(half.gain, 0.5, 1e-6);
  EXPECT_LT(half.left_free, 1e-6);
  EXPECT_GT(half.left, 0.2 * half.level);
}

TEST(FrameResidual, PassesOverAFifthOfThePixels) {
  cv::Mat1f picture = Model();
  for (int i = 10; i < 25; ++i) picture(i / 11, i % 11) += 1.0f;
  EXPECT_LT(Compare(picture, Model()).left_free, 0.2);
  for (int i = 10; i < 60; ++i) picture(i / 11, i % 11) = 1.0f;
  EXPECT_GT(Compare(picture, Model()).left, 0.2);
}

TEST(FrameResidual, OfNoPixelsIsNothing) {
  const FrameResidual none = Compare(Model(), cv::Mat1f(10, 11, kNothing));
  EXPECT_EQ(none.pixels, 0u);
  EXPECT_EQ(none.gain, 1.0);
}

TEST(Only, LeavesTheFramesThatAreAskedFor) {
  const Capture capture = Captured(SmallCapture(1, Shape::kSphere, 6));
  const target::Geometry geometry(capture.session.target);
  const calib::RayGrid rays(capture.session.camera);
  const auto all =
      observe::BuildObservations(rig::sim::ToKeyframes(capture.session), geometry, rays);
  const observe::Observations some = Only(all, {true, false, true, true, false, true});
  EXPECT_LT(some.used, all.used);
  EXPECT_EQ(some.tile_begin, all.tile_begin);
  std::size_t used = 0;
  for (std::size_t k = 0; k < 6; ++k)
    for (std::size_t i = all.tile_begin[k] * observe::kTile;
         i < all.tile_begin[k + 1] * observe::kTile; ++i) {
      const bool there = some.pixel[i] != observe::Observations::kNoPixel;
      EXPECT_FALSE(there && (k == 1 || k == 4));
      used += there ? 1 : 0;
    }
  EXPECT_EQ(used, some.used);
}

}  // namespace
}  // namespace turnlight::estimator::consistency
