// Proves: a ball's centre follows from its outline, of a mask or of a picture, whole or cut by the
// picture's edge, with a stand below it, within its sigmas; what is no ball is refused.
#include "calib/calibrate/probe/outline.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "tests/calib/calibrate/probe/ball_pictures.h"

namespace turnlight::calib::calibrate::probe {
namespace {

using Eigen::Vector3d;

cv::Mat1b MaskOf(const BallStudio& studio) {
  cv::Mat1b mask(studio.camera.height(), studio.camera.width(), uchar{0});
  const BallView& view = studio.views.front();
  for (int row = 0; row < mask.rows; ++row)
    for (int column = 0; column < mask.cols; ++column)
      if (MirrorAt(view, Eigen::Vector2d(column, row))) mask(row, column) = 255;
  return mask;
}

Vector3d TruthIn(const BallStudio& studio) {
  return studio.views.front().X_WC.Inverse() * studio.views.front().ball.center;
}

void ExpectFound(const Result<OutlineBall>& ball, const BallStudio& studio) {
  ASSERT_TRUE(ball) << ball.error().text;
  const Vector3d off = ball->center_C - TruthIn(studio);
  // A tenth of a pixel across.
  EXPECT_LT(off.head<2>().norm(), 0.1 * 420.0 / 1900.0);
  EXPECT_LT(std::abs(off.z()), 420.0 * 0.01);
  EXPECT_LT(off.dot(ball->covariance.inverse() * off), 14.2);
}

TEST(Outline, OfAMask) {
  BallPictures pictures;
  pictures.ball.center = Vector3d(3.0, -2.0, 4.0);
  const BallStudio studio(pictures);
  const auto ball = FitOutline(MaskOutline(MaskOf(studio)), studio.camera, 25.0, 0.2, "frame 0");
  ExpectFound(ball, studio);
  EXPECT_NEAR(ball->share_seen, 1.0, 1e-9);
  EXPECT_LT(ball->rms_px, 0.5);
}

TEST(Outline, OfABallThatThePictureCuts) {
  BallPictures pictures;
  pictures.width = pictures.height = 220;
  pictures.ball.center = Vector3d(5.0, -10.0, 6.0);
  const BallStudio studio(pictures);
  const auto ball = FitOutline(MaskOutline(MaskOf(studio)), studio.camera, 25.0, 0.2, "frame 0");
  ASSERT_TRUE(ball) << ball.error().text;
  EXPECT_LT(ball->share_seen, 0.95);
  const Vector3d off = ball->center_C - TruthIn(studio);
  EXPECT_LT(off.dot(ball->covariance.inverse() * off), 14.2);
}

TEST(Outline, AStandIsLeftOut) {
  const BallStudio studio{BallPictures{}};
  cv::Mat1b mask = MaskOf(studio);
  mask(cv::Rect(130, 250, 60, 70)) = 255;
  ExpectFound(FitOutline(MaskOutline(mask), studio.camera, 25.0, 0.2, "frame 0"), studio);
}

TEST(Outline, OfAPictureNearTheGuess) {
  BallPictures pictures;
  pictures.noise = 0.005;
  pictures.room.ceiling = 0.6;
  pictures.room.floor = 0.3;
  pictures.room.background = 0.05;
  const BallStudio studio(pictures);
  const Vector3d guess = TruthIn(studio) + Vector3d(0.8, -0.6, 5.0);
  const auto points =
      EdgeOutline(cv::Mat1f(TakePicture(pictures, studio, 0).radiance), studio.camera, guess, 25.0);
  ExpectFound(FitOutline(points, studio.camera, 25.0, 0.15, "frame 0"), studio);
}

TEST(Outline, WhatIsNoBallIsRefused) {
  const BallStudio studio{BallPictures{}};
  cv::Mat1b mask(320, 320, uchar{0});
  const auto nothing = FitOutline(MaskOutline(mask), studio.camera, 25.0, 0.2, "frame 7");
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().text.find("frame 7: the ball's outline has 0 points"), 0u);
  mask(cv::Rect(60, 60, 200, 150)) = 255;
  const auto square = FitOutline(MaskOutline(mask), studio.camera, 25.0, 0.2, "frame 7");
  ASSERT_FALSE(square);
  EXPECT_NE(square.error().text.find("not a ball's"), std::string::npos) << square.error().text;
}

}  // namespace
}  // namespace turnlight::calib::calibrate::probe
