// Proves: a pose is found to rounding from exact pixels, through lenses that distort, at any tilt;
// its covariance covers what noise does to it; a tilt that the picture leaves open is told; what
// cannot give a pose is refused. Does not prove: anything of how points are found in pictures.
#include "calib/calibrate/handheld/plane_pose.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "base/angles.h"
#include "base/random.h"

namespace turnlight::calib::calibrate::handheld {
namespace {

CameraModel Distorting() {
  auto camera = CameraModel::FromString(
      "{ 'lensmodel': 'LENSMODEL_OPENCV8', 'intrinsics': [ 900., 905., 639.5, 479.5, -0.2, 0.08, "
      "1e-3, "
      "-5e-4, 0.01, 0.05, 0.02, 0.003 ], 'extrinsics': [ 0,0,0,0,0,0 ], 'imagersize': [ 1280, 960 "
      "] }",
      "test");
  if (!camera) throw std::runtime_error(camera.error().text);
  return *camera;
}

// Tilted from facing the camera, turned in its plane.
Pose Tilted(double tilt_deg, double turn_deg, double distance) {
  Pose pose;
  pose.rotation = (Eigen::AngleAxisd(DegToRad(tilt_deg), Eigen::Vector3d(0.6, 0.8, 0.0)) *
                   Eigen::AngleAxisd(DegToRad(turn_deg), Eigen::Vector3d::UnitZ()))
                      .toRotationMatrix();
  pose.translation = {15.0, -10.0, distance};
  return pose;
}

std::vector<SeenPosition> See(const CameraModel& camera, const Pose& X_CB, int side, double spacing,
                              double noise_px, const RandomStream& random) {
  std::vector<SeenPosition> points;
  std::vector<Eigen::Vector3d> p_C;
  const double middle = 0.5 * spacing * (side - 1);
  for (int i = 0; i < side * side; ++i) {
    SeenPosition point;
    point.p_B = {spacing * (i % side) - middle, spacing * (i / side) - middle};
    p_C.push_back(X_CB * Eigen::Vector3d(point.p_B.x(), point.p_B.y(), 0.0));
    points.push_back(point);
  }
  const auto pixels = camera.Project(p_C);
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i].pixel =
        pixels[i] + noise_px * Eigen::Vector2d(random.Normal(2 * i), random.Normal(2 * i + 1));
  return points;
}

// Rotation vector (C's axes) and shift that lead from one pose to another.
Eigen::Matrix<double, 6, 1> Difference(const Pose& to, const Pose& from) {
  const Eigen::AngleAxisd turn(to.rotation * from.rotation.transpose());
  Eigen::Matrix<double, 6, 1> difference;
  difference << turn.angle() * turn.axis(), to.translation - from.translation;
  return difference;
}

TEST(PlanePose, ExactPixelsGiveTheExactPose) {
  const CameraModel camera = Distorting();
  for (const double tilt : {5.0, 30.0, 70.0})
    for (const double turn : {0.0, 77.0, 190.0})
      for (const int side : {2, 7}) {
        const Pose truth = Tilted(tilt, turn, 420.0);
        const auto found = EstimatePlanePose(
            camera, See(camera, truth, side, 140.0 / side, 0.0, RandomStream(1, 0)), 0.1);
        ASSERT_TRUE(found) << found.error().text;
        EXPECT_LT(Difference(found->X_CB, truth).head<3>().norm(), 1e-7) << tilt << " " << turn;
        EXPECT_LT(Difference(found->X_CB, truth).tail<3>().norm(), 1e-5) << tilt << " " << turn;
      }
}

// Squared distances in the covariance's metric have six degrees of freedom.
TEST(PlanePose, TheCovarianceCoversWhatNoiseDoes) {
  const CameraModel camera = Distorting();
  const Pose truth = Tilted(35.0, 20.0, 420.0);
  double sum = 0.0;
  constexpr int kDraws = 300;
  for (int draw = 0; draw < kDraws; ++draw) {
    const auto found = EstimatePlanePose(
        camera, See(camera, truth, 7, 20.0, 0.3, RandomStream(static_cast<std::uint64_t>(draw), 0)),
        0.0);
    ASSERT_TRUE(found);
    const auto difference = Difference(found->X_CB, truth);
    sum += difference.dot(found->covariance.ldlt().solve(difference));
  }
  // Six on average, plus what an estimated sigma of 92 degrees of freedom adds; its scatter is
  // sqrt(12 / 300) = 0.2.
  EXPECT_NEAR(sum / kDraws, 6.0 * 92.0 / 90.0, 0.8);
}

TEST(PlanePose, TheKnownNoiseCountsWhereFewPointsFitByChance) {
  const CameraModel camera = Distorting();
  const auto corners = See(camera, Tilted(30.0, 0.0, 420.0), 2, 100.0, 0.0, RandomStream(1, 0));
  const auto sure = EstimatePlanePose(camera, corners, 0.1);
  const auto rough = EstimatePlanePose(camera, corners, 1.0);
  ASSERT_TRUE(sure && rough);
  EXPECT_NEAR(rough->covariance(5, 5) / sure->covariance(5, 5), 100.0, 1.0);
}

TEST(PlanePose, ATiltThatThePictureLeavesOpenIsTold) {
  const CameraModel camera = Distorting();
  const auto far = See(camera, Tilted(20.0, 0.0, 9000.0), 4, 10.0, 0.3, RandomStream(3, 0));
  const auto open = EstimatePlanePose(camera, far, 0.3);
  ASSERT_TRUE(open) << open.error().text;
  EXPECT_LT(open->mirrored_ratio, 2.0);
  const auto near = See(camera, Tilted(20.0, 0.0, 300.0), 4, 40.0, 0.3, RandomStream(3, 0));
  const auto plain = EstimatePlanePose(camera, near, 0.3);
  ASSERT_TRUE(plain);
  EXPECT_GT(plain->mirrored_ratio, 5.0);
}

TEST(PlanePose, WhatGivesNoPoseIsRefused) {
  const CameraModel camera = Distorting();
  auto points = See(camera, Tilted(30.0, 0.0, 420.0), 2, 100.0, 0.0, RandomStream(1, 0));
  const std::vector<SeenPosition> three(points.begin(), points.begin() + 3);
  EXPECT_NE(EstimatePlanePose(camera, three, 0.1).error().text.find("3 points"), std::string::npos);
  std::vector<SeenPosition> line;
  for (int i = 0; i < 5; ++i)
    line.push_back({{10.0 * i, 5.0 * i}, {600.0 + 20.0 * i, 500.0 + 10.0 * i}, 1.0});
  EXPECT_NE(EstimatePlanePose(camera, line, 0.1).error().text.find("on a line"), std::string::npos);
  points[2].pixel = {1e6, 1e6};
  const auto far = EstimatePlanePose(camera, points, 0.1);
  ASSERT_FALSE(far);
  EXPECT_NE(far.error().text.find("the point at pixel 1000000.0, 1000000.0 lies "),
            std::string::npos);
  points[2].pixel.x() = std::nan("");
  EXPECT_FALSE(EstimatePlanePose(camera, points, 0.1));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::handheld
