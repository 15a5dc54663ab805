// Proves: rays are mirrored by the law of reflection, and the point that shows a light is the one
// whose mirrored ray meets it, for distant lights and near ones. Not: lenses, which the camera
// model's tests have.
#include "calib/calibrate/probe/ball.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/angles.h"
#include "base/random.h"
#include "tests/calib/calibrate/probe/ball_pictures.h"

namespace turnlight::calib::calibrate::probe {
namespace {

using Eigen::Vector3d;

TEST(Ball, ARayThroughTheCentreComesBack) {
  const auto seen = MirrorOnBall({{0, 0, 10}, 2.0}, {0, 0, 0}, {0, 0, 1});
  ASSERT_TRUE(seen);
  EXPECT_NEAR((seen->point - Vector3d(0, 0, 8)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((seen->direction - Vector3d(0, 0, -1)).norm(), 0.0, 1e-12);
  EXPECT_NEAR(seen->cosine, 1.0, 1e-12);
}

TEST(Ball, ARayThatMissesSeesNothing) {
  EXPECT_FALSE(MirrorOnBall({{0, 0, 10}, 2.0}, {0, 0, 0}, Vector3d(1, 0, 1).normalized()));
  EXPECT_FALSE(MirrorOnBall({{0, 0, -10}, 2.0}, {0, 0, 0}, {0, 0, 1}));
  EXPECT_FALSE(MirrorOnBall({{0, 0, 10}, 2.0}, {0, 0, 0}, {NAN, 0, 1}));
}

// Where the ball shows a light, the mirrored ray leads to it.
TEST(Ball, ThePointThatShowsALightMirrorsIt) {
  const RandomStream random(3, 0);
  const Ball ball{{10, -5, 3}, 25.0};
  const Vector3d eye(300, 120, 200);
  int shown = 0;
  for (int i = 0; i < 200; ++i) {
    const auto draw = [&](int k) { return random.Uniform(10 * i + k, -1.0, 1.0); };
    const Vector3d u = Vector3d(draw(0), draw(1), draw(2)).normalized();
    const double rho = i % 2 == 0 ? 0.0 : 0.002 * (1.0 + draw(3));
    const auto point = MirrorPoint(ball, eye, u, rho);
    if (!point) continue;
    const auto seen = MirrorOnBall(ball, eye, (*point - eye).normalized());
    ASSERT_TRUE(seen);
    if (seen->cosine < 0.05) continue;
    EXPECT_NEAR((seen->direction - (u - rho * *point).normalized()).norm(), 0.0, 1e-6);
    ++shown;
  }
  EXPECT_GT(shown, 150);
}

TEST(Ball, ALightBehindTheBallIsHidden) {
  const Ball ball{{0, 0, 0}, 25.0};
  EXPECT_FALSE(MirrorPoint(ball, {0, 0, 400}, {0, 0, -1}, 0.0));
}

TEST(Ball, AnImagePointAndItsLightAgree) {
  BallPictures pictures;
  const BallStudio studio(pictures);
  const BallView& view = studio.views.front();
  const Eigen::Vector2d pixel(120.3, 200.7);
  const auto seen = MirrorAt(view, pixel);
  ASSERT_TRUE(seen);
  const auto again = PixelOfLight(view, seen->direction, 0.0);
  ASSERT_TRUE(again);
  EXPECT_NEAR((*again - pixel).norm(), 0.0, 1e-5);
  EXPECT_NEAR(RadiusInPixels(view), 1900.0 * std::asin(25.0 / 420.0), 0.5);
}

TEST(Ball, TheDifferentialIsThatOfTheMirroredDirection) {
  const BallStudio studio{BallPictures{}};
  const BallView& view = studio.views.front();
  const Eigen::Vector2d pixel(140.0, 190.0), step(0.01, -0.02);
  const auto differential = MirrorDifferential(view, pixel);
  ASSERT_TRUE(differential);
  const Vector3d moved = MirrorAt(view, pixel + step)->direction - MirrorAt(view, pixel)->direction;
  EXPECT_NEAR((moved - *differential * step).norm(), 0.0, 1e-5);
}

}  // namespace
}  // namespace turnlight::calib::calibrate::probe
