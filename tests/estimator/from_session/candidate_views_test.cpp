// Proves: between frames of a turntable the candidates are the poses that the table would give, and
// of a camera that goes round likewise; a turn that is not whole is gone on with; nothing is
// between frames that are far apart; exposures come where the noise is known; many frames give no
// more than is allowed. Does not prove that they help: tests/estimator/next_view_test.cpp does.
#include "estimator/from_session/candidate_views.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "calib/rig_geometry.h"

namespace turnlight::estimator::from_session {
namespace {

calib::RigGeometry Table() {
  calib::TurntableGeometry table;
  table.X_WC = calib::LookAtOrigin(0.3, 0.5, 400.0);
  table.X_WA = calib::Turn(Eigen::Vector3d(1.0, 2.0, 0.5).normalized(), 0.2);
  table.X_WA.translation = {10.0, -20.0, 3.0};
  table.X_AT.translation = {5.0, 6.0, 30.0};
  return table;
}

rig::Session SessionAt(const calib::RigGeometry& geometry, const std::vector<double>& angles_deg) {
  rig::Session session;
  for (const double angle_deg : angles_deg) {
    rig::FrameRecord& frame = session.frames.emplace_back();
    const calib::RigPoses poses = calib::PosesAt(geometry, angle_deg);
    frame.angle_deg = angle_deg;
    frame.exposure.exposure_us = 1000.0;
    frame.X_WC = poses.X_WC;
    frame.X_WT = poses.X_WT;
  }
  return session;
}

std::vector<CandidateView> Of(const rig::Session& session) {
  std::vector<std::size_t> frames(session.frames.size());
  std::iota(frames.begin(), frames.end(), 0u);
  return CandidatesOf(session, frames);
}

std::vector<double> Angles(const std::vector<CandidateView>& views) {
  std::vector<double> out;
  for (const CandidateView& view : views) out.push_back(*view.angle_deg);
  return out;
}

void ExpectPose(const calib::Pose& is, const calib::Pose& expected) {
  EXPECT_LT((is.rotation - expected.rotation).norm(), 1e-9);
  EXPECT_LT((is.translation - expected.translation).norm(), 1e-6);
}

TEST(CandidatesOf, AreWhereTheRigWouldTakeThem) {
  for (const calib::RigGeometry& geometry :
       {Table(), calib::RigGeometry(calib::OrbitGeometry{30.0, 420.0, {}})}) {
    const auto views = Of(SessionAt(geometry, {0.0, 90.0, 180.0, 270.0}));
    EXPECT_THAT(Angles(views), testing::ElementsAre(22.5, 45.0, 67.5, 112.5, 135.0, 157.5, 202.5,
                                                    225.0, 247.5, 292.5, 315.0, 337.5));
    for (const CandidateView& view : views) {
      const calib::RigPoses expected = calib::PosesAt(geometry, *view.angle_deg);
      ExpectPose(view.poses.X_WC, expected.X_WC);
      ExpectPose(view.poses.X_WT, expected.X_WT);
    }
    EXPECT_EQ(views[1].label, "at 45\u00b0");
  }
}

TEST(CandidatesOf, GoOnWithATurnThatIsNotWhole) {
  const auto angles = Angles(Of(SessionAt(Table(), {0.0, 40.0})));
  EXPECT_EQ(angles.front(), 10.0);
  EXPECT_EQ(angles.back(), 350.0);
  EXPECT_THAT(angles, testing::Contains(80.0)) << "whole steps, too";
}

TEST(CandidatesOf, NothingIsBetweenFramesThatAreFarApart) {
  EXPECT_TRUE(Of(SessionAt(Table(), {0.0, 150.0})).empty());
  EXPECT_TRUE(Of(SessionAt(Table(), {0.0})).empty());
  EXPECT_TRUE(Of(SessionAt(Table(), {30.0, 30.0})).empty());
}

TEST(CandidatesOf, FramesWithoutAnglesAreNamedByTheirNumbers) {
  rig::Session session = SessionAt(Table(), {0.0, 40.0, 80.0});
  session.frames[1].angle_deg.reset();
  const auto views = Of(session);
  ASSERT_EQ(views.size(), 6u);
  EXPECT_FALSE(views[0].angle_deg.has_value());
  EXPECT_EQ(views[0].label, "25 % of the way from frame 0 to frame 1");
  ExpectPose(views[4].poses.X_WT, calib::PosesAt(Table(), 60.0).X_WT);
}

TEST(CandidatesOf, OtherExposuresWhereTheNoiseIsKnown) {
  rig::Session session = SessionAt(Table(), {0.0, 90.0, 180.0, 270.0});
  session.radiometry.noise = calib::NoiseModel{1.0, 0.1, {}};
  const auto views = Of(session);
  ASSERT_EQ(views.size(), 20u);
  EXPECT_EQ(views[1].exposure.exposure_us, 1000.0);
  EXPECT_EQ(views[2].exposure.exposure_us, 2000.0);
  EXPECT_EQ(views[3].exposure.exposure_us, 500.0);
  EXPECT_EQ(views[2].label, "at 45\u00b0 with 2 times the exposure");
}

TEST(CandidatesOf, AreNotMoreThanAllowed) {
  std::vector<double> angles_deg;
  for (int i = 0; i < 360; ++i) angles_deg.push_back(i);
  const auto views = Of(SessionAt(Table(), angles_deg));
  EXPECT_LE(views.size(), kMostCandidates);
  EXPECT_GT(views.size(), kMostCandidates / 2);
  EXPECT_GT(*views.back().angle_deg, 340.0) << "spread over the turn";
}

}  // namespace
}  // namespace turnlight::estimator::from_session
