// Proves: a table's angle becomes the pose X_WA Rz(scale angle + offset) X_AT, in closed form and
// bit for bit where W lies on the axis; a camera that goes round keeps distance, level and aim.
// Does not prove: that a rig's numbers are the right ones.
#include "calib/rig_geometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>

namespace turnlight::calib {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;

// The sign of a zero counts, too: it is printed.
bool SameBits(const Pose& a, const Pose& b) {
  return std::memcmp(a.rotation.data(), b.rotation.data(), sizeof(double) * 9) == 0 &&
         std::memcmp(a.translation.data(), b.translation.data(), sizeof(double) * 3) == 0;
}

TEST(RigGeometry, APointTurnsCounterClockwiseAboutTheAxis) {
  TurntableGeometry rig;
  rig.X_WC.translation = {0.0, 0.0, 500.0};
  rig.X_WA.translation = {100.0, 20.0, 0.0};
  rig.X_AT.translation = {10.0, 0.0, 5.0};
  const RigPoses start = PosesAt(rig, 0.0), quarter = PosesAt(rig, 90.0);
  EXPECT_TRUE(start.X_WT.translation.isApprox(Eigen::Vector3d(110.0, 20.0, 5.0), 1e-15));
  EXPECT_TRUE(quarter.X_WT.translation.isApprox(Eigen::Vector3d(100.0, 30.0, 5.0), 1e-15));
  EXPECT_TRUE(SameBits(quarter.X_WC, rig.X_WC));
}

// An axis that leans: what is on it stays, whatever the angle.
TEST(RigGeometry, WhatIsOnTheAxisStays) {
  TurntableGeometry rig;
  rig.X_WA = {Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 0).normalized()).toRotationMatrix(),
              {1.0, -2.0, 3.0}};
  rig.X_AT.translation = {0.0, 0.0, 40.0};
  const Eigen::Vector3d still = rig.X_WA * rig.X_AT.translation;
  for (const double angle_deg : {-400.0, 0.0, 33.0, 180.0, 719.0})
    EXPECT_TRUE(PosesAt(rig, angle_deg).X_WT.translation.isApprox(still, 1e-15)) << angle_deg;
}

TEST(RigGeometry, ScaleAndOffsetAreOfTheReportedAngle) {
  TurntableGeometry plain, scaled;
  plain.X_AT.translation = scaled.X_AT.translation = {10.0, 0.0, 0.0};
  scaled.angle_scale = -0.5;
  scaled.angle_offset_deg = 30.0;
  for (const double angle_deg : {-90.0, 0.0, 7.0, 360.0})
    EXPECT_TRUE(
        SameBits(PosesAt(scaled, angle_deg).X_WT, PosesAt(plain, -0.5 * angle_deg + 30.0).X_WT))
        << angle_deg;
}

// Sessions of simulated rigs have these poses: their bytes follow from the bits.
TEST(RigGeometry, WithWOnTheAxisTheBitsAreThoseOfTheTurnAlone) {
  TurntableGeometry rig;
  rig.X_AT = Turn(Eigen::Vector3d::UnitY(), 17.0 * kDeg);
  for (int i = -400; i <= 400; ++i) {
    const double angle_deg = 1.7 * i;
    const Pose turned = Turn(Eigen::Vector3d::UnitZ(), angle_deg * kDeg) * rig.X_AT;
    EXPECT_TRUE(SameBits(PosesAt(rig, angle_deg).X_WT, turned)) << angle_deg;
  }
}

TEST(RigGeometry, ACameraThatGoesRoundKeepsDistanceLevelAndAim) {
  OrbitGeometry rig;
  rig.elevation_deg = 30.0;
  rig.distance = 420.0;
  rig.X_WT = Turn(Eigen::Vector3d::UnitY(), 0.2);
  for (int i = -36; i <= 72; ++i) {
    const RigPoses at = PosesAt(rig, 10.0 * i);
    const double azimuth = 10.0 * i * kDeg;
    const Eigen::Vector3d place(std::cos(30.0 * kDeg) * std::cos(azimuth),
                                std::cos(30.0 * kDeg) * std::sin(azimuth), 0.5);
    EXPECT_TRUE(at.X_WC.translation.isApprox(420.0 * place, 1e-14)) << i;
    const Eigen::Vector3d origin_C = at.X_WC.Inverse() * Eigen::Vector3d::Zero();
    EXPECT_TRUE(origin_C.isApprox(Eigen::Vector3d(0.0, 0.0, 420.0), 1e-14)) << i;
    EXPECT_EQ(at.X_WC.rotation(2, 0), 0.0) << i;                   // x is level
    EXPECT_LT(at.X_WC.rotation(2, 1), 0.0) << i;                   // y is down
    EXPECT_NEAR(at.X_WC.rotation.determinant(), 1.0, 1e-14) << i;  // no mirror
    EXPECT_TRUE(SameBits(at.X_WT, rig.X_WT)) << i;
  }
}

}  // namespace
}  // namespace turnlight::calib
