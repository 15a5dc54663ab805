// Proves: a walk round a plane gives its poses and a keyframe every ten degrees; a board that looks
// the same from four sides keeps its sides, and what cannot be told is left out with its reason.
// Does not prove: anything of how points are found in pictures.
#include "calib/calibrate/handheld/registration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "base/angles.h"
#include "base/random.h"
#include "calib/rig_geometry.h"

namespace turnlight::calib::calibrate::handheld {
namespace {

using testing::HasSubstr;

constexpr int kSide = 5;
constexpr double kSpacing = 20.0;

CameraModel Camera() { return CameraModel::Pinhole(1280, 960, 1000.0, 1000.0, 639.5, 479.5); }

// A square board centred at B's origin; numbered from the side that `turn_deg` leads to, as a
// detector may.
PlaneView See(double azimuth_deg, double turn_deg, double noise_px) {
  const Pose X_CB = LookAtOrigin(DegToRad(azimuth_deg), DegToRad(40.0), 500.0).Inverse();
  const RandomStream random(static_cast<std::uint64_t>(azimuth_deg * 10.0 + 1000.0), 5);
  PlaneView view;
  view.name = "at " + std::to_string(azimuth_deg);
  std::vector<Eigen::Vector3d> p_C;
  const Eigen::Matrix3d turned = Turn(Eigen::Vector3d::UnitZ(), DegToRad(turn_deg)).rotation;
  for (int i = 0; i < kSide * kSide; ++i) {
    const Eigen::Vector3d p(kSpacing * (i % kSide - 2), kSpacing * (i / kSide - 2), 0.0);
    view.points.push_back({p.head<2>(), {}, 1.0});
    p_C.push_back(X_CB * (turned * p));
  }
  const auto pixels = Camera().Project(p_C);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    view.points[i].pixel =
        pixels[i] + noise_px * Eigen::Vector2d(random.Normal(2 * i), random.Normal(2 * i + 1));
  return view;
}

double AzimuthDeg(const RegisteredView& view) {
  const Eigen::Vector3d p_B = view.pose->X_CB.Inverse().translation;
  return RadToDeg(std::atan2(p_B.y(), p_B.x()));
}

RegistrationOptions FourSides() {
  RegistrationOptions options;
  for (const double turn_deg : {90.0, 180.0, 270.0})
    options.same_looking.push_back(Turn(Eigen::Vector3d::UnitZ(), DegToRad(turn_deg)));
  return options;
}

TEST(Registration, AWalkGivesAKeyframeEveryTenDegrees) {
  std::vector<PlaneView> views;
  for (int i = 0; i <= 50; ++i) views.push_back(See(2.0 * i, 0.0, 0.2));
  const auto registered = RegisterViews(Camera(), views, Pose{}, {});
  int keyframes = 0;
  for (std::size_t i = 0; i < registered.size(); ++i) {
    ASSERT_TRUE(registered[i].pose) << registered[i].why_left_out;
    EXPECT_NEAR(AzimuthDeg(registered[i]), 2.0 * static_cast<double>(i), 0.2);
    keyframes += registered[i].keyframe;
    EXPECT_TRUE(!registered[i].keyframe || i == 0 || registered[i].view_change_deg >= 10.0);
  }
  // At an elevation of 40 degrees, 100 degrees of azimuth are 71.8 along the great circles of
  // neighbours: a keyframe at most every 14 degrees of azimuth.
  EXPECT_GE(keyframes, 7);
  EXPECT_LE(keyframes, 8);
}

TEST(Registration, ABoardThatLooksTheSameFromFourSidesKeepsThem) {
  std::vector<PlaneView> views;
  const double numbered_from[] = {0.0, 90.0, 270.0, 180.0};
  for (int i = 0; i < 36; ++i) views.push_back(See(10.0 * i, numbered_from[i * 7 % 4], 0.1));
  const auto registered = RegisterViews(Camera(), views, Pose{}, FourSides());
  for (std::size_t i = 0; i < registered.size(); ++i) {
    ASSERT_TRUE(registered[i].pose) << registered[i].why_left_out;
    EXPECT_NEAR(std::remainder(AzimuthDeg(registered[i]) - 10.0 * static_cast<double>(i), 360.0),
                0.0, 0.2);
  }
}

TEST(Registration, ATurnThatCannotBeToldIsLeftOut) {
  const auto registered =
      RegisterViews(Camera(), {See(0.0, 0.0, 0.1), See(46.0, 0.0, 0.1), See(10.0, 0.0, 0.1)},
                    Pose{}, FourSides());
  EXPECT_FALSE(registered[1].pose);
  EXPECT_THAT(registered[1].why_left_out, HasSubstr("which side is up cannot be told"));
  EXPECT_TRUE(registered[2].pose);
}

// Numbered from another corner, the same picture is the same camera with the same uncertainty.
TEST(Registration, TheCovarianceGoesWithTheNumbering) {
  const Eigen::Vector3d shift(30.0, -50.0, 0.0);
  RegistrationOptions options;
  Pose turn = Turn(Eigen::Vector3d::UnitZ(), DegToRad(180.0));
  turn.translation = shift;
  options.same_looking = {turn};
  PlaneView other = See(20.0, 0.0, 0.1);
  for (SeenPosition& point : other.points)
    point.p_B = (turn * Eigen::Vector3d(point.p_B.x(), point.p_B.y(), 0.0)).head<2>();
  const auto direct = RegisterViews(Camera(), {See(20.0, 0.0, 0.1)}, Pose{}, {});
  const auto carried = RegisterViews(Camera(), {See(15.0, 0.0, 0.0), other}, Pose{}, options);
  ASSERT_TRUE(carried[1].pose) << carried[1].why_left_out;
  EXPECT_NEAR((carried[1].pose->X_CB.translation - direct[0].pose->X_CB.translation).norm(), 0.0,
              1e-5);
  EXPECT_TRUE(carried[1].pose->covariance.isApprox(direct[0].pose->covariance, 1e-3));
}

TEST(Registration, WhatShowsNoPlaneOrFitsBadlyIsLeftOutWithItsReason) {
  PlaneView none{"none", {}, "no board in it"};
  PlaneView crooked = See(30.0, 0.0, 0.1);
  for (std::size_t i = 0; i < crooked.points.size(); i += 2) crooked.points[i].pixel.x() += 12.0;
  const auto registered = RegisterViews(Camera(), {none, crooked}, Pose{}, {});
  EXPECT_EQ(registered[0].why_left_out, "no board in it");
  EXPECT_THAT(registered[1].why_left_out, HasSubstr("px rms off"));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::handheld
