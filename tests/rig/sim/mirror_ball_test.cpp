// Proves: the simulated mirror ball shows a lamp where the law of reflection says, with its energy,
// and nothing else. Not: lenses' aberrations.
#include "rig/sim/mirror_ball.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calib/rig_geometry.h"

namespace turnlight::rig::sim {
namespace {

const calib::CameraModel& Camera() {
  static const calib::CameraModel camera =
      calib::CameraModel::Pinhole(200, 200, 1200.0, 1200.0, 99.5, 99.5);
  return camera;
}

cv::Mat1f Render(const MirrorRoom& room, double blur) {
  const calib::RayGrid rays(Camera());
  // From +z, looking down.
  const calib::Pose X_WC = calib::LookAtOrigin(0.0, 0.5 * M_PI, 420.0);
  return RenderMirrorBall({}, room, rays, X_WC, blur);
}

// The normal halves the angle between the way back to the camera and the lamp: of one 60 degrees
// from the axis it is a little less than 30 degrees from it, as the camera is not far away.
TEST(MirrorBall, ALampIsSeenHalfWay) {
  MirrorRoom room;
  room.lamps = {{{std::sin(M_PI / 3), 0.0, std::cos(M_PI / 3)}, 0.0, 0.02, 1.0}};
  const cv::Mat1f picture = Render(room, 0.0);
  const cv::Moments moments = cv::moments(picture);
  const Eigen::Vector2d at(moments.m10 / moments.m00 - 99.5, moments.m01 / moments.m00 - 99.5);
  double normal = M_PI / 6;
  for (int i = 0; i < 20; ++i) {
    const double off = std::atan2(25.0 * std::sin(normal), 420.0 - 25.0 * std::cos(normal));
    normal = 0.5 * (M_PI / 3 - off);
  }
  const double expected = 1200.0 * 25.0 * std::sin(normal) / (420.0 - 25.0 * std::cos(normal));
  EXPECT_NEAR(at.norm(), expected, 0.05);
}

TEST(MirrorBall, BlurKeepsTheEnergy) {
  MirrorRoom room;
  room.lamps = {{{0.5, 0.2, 0.8}, 0.0, 0.03, 2.0}};
  room.lamps[0].direction.normalize();
  const double sharp = cv::sum(Render(room, 0.0))[0];
  EXPECT_GT(sharp, 1.0);
  EXPECT_NEAR(cv::sum(Render(room, 1.2))[0], sharp, 1e-3 * sharp);
}

TEST(MirrorBall, TheRoomIsBehindTheLamps) {
  MirrorRoom room;
  room.ceiling = room.floor = 0.25;
  room.background = 0.75;
  const cv::Mat1f picture = Render(room, 0.0);
  EXPECT_NEAR(picture(100, 100), 0.25, 1e-6);
  EXPECT_NEAR(picture(2, 2), 0.75, 1e-6);
}

}  // namespace
}  // namespace turnlight::rig::sim
