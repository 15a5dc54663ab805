// Proves: a session on disk becomes views, spots and perturbations; a ball that is elsewhere than
// the session says is found from its outlines; what is uncertain goes into the perturbations; what
// is no ball is refused.
#include "calib/calibrate/probe/probe_session.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/angles.h"
#include "tests/calib/calibrate/probe/ball_session.h"
#include "tests/temporary_folder.h"

namespace turnlight::calib::calibrate::probe {
namespace {

using Eigen::Vector3d;

BallPictures Scene() {
  BallPictures pictures;
  pictures.views = 3;
  pictures.noise = 0.002;
  pictures.white = 1.0;
  pictures.room.ceiling = 0.3;
  pictures.room.floor = 0.2;
  pictures.room.lamps = {{Vector3d(0.3, 0.2, 0.9).normalized(), 0.0, DegToRad(1.0), 5.0}};
  return pictures;
}

bool GoOn() { return true; }

double WorstErrorDeg(const ProbeSession& session, const Vector3d& truth) {
  double worst = 0.0;
  for (std::size_t i = 0; i < session.views.size(); ++i) {
    if (session.spots[i].empty()) return 180.0;
    const auto seen = MirrorAt(session.views[i], session.spots[i][0].pixel);
    worst = std::max(worst, RadToDeg(std::acos(std::min(1.0, seen->direction.dot(truth)))));
  }
  return worst;
}

TEST(ProbeSession, TheSessionsPlaceIsTaken) {
  const TemporaryFolder folder;
  const BallPictures pictures = Scene();
  WriteBallSession(pictures, false, Vector3d::Zero(), folder.path());
  const auto session = ReadProbeSession(folder.path(), {}, GoOn);
  ASSERT_TRUE(session) << session.error().text;
  ASSERT_EQ(session->views.size(), 3u);
  EXPECT_TRUE(session->perturbations.empty());
  EXPECT_FALSE(session->center_T);
  EXPECT_LT(WorstErrorDeg(*session, pictures.room.lamps[0].direction), 0.1);
}

TEST(ProbeSession, OutlinesFindTheBall) {
  for (const bool masks : {true, false}) {
    const TemporaryFolder folder;
    const BallPictures pictures = Scene();
    const Vector3d off(0.8, -0.5, 0.6);
    WriteBallSession(pictures, masks, off, folder.path());
    ProbeOptions options;
    options.sphere_from_outline = true;
    options.radius_sigma = 0.01;
    const auto session = ReadProbeSession(folder.path(), options, GoOn);
    ASSERT_TRUE(session) << session.error().text;
    ASSERT_TRUE(session->center_T);
    const Vector3d error = *session->center_T + off;
    EXPECT_LT(error.norm(), 0.08);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_LT(std::abs(error[axis]), 3.5 * (*session->center_sigma_T)[axis]);
    ASSERT_EQ(session->perturbations.size(), 4u);
    EXPECT_EQ(session->perturbations[0].item, "ball centre");
    EXPECT_EQ(session->perturbations[3].item, "ball radius");
    EXPECT_LT(WorstErrorDeg(*session, pictures.room.lamps[0].direction), 0.4);
  }
}

TEST(ProbeSession, ACalibrationsPosesAreUncertain) {
  const TemporaryFolder folder;
  WriteBallSession(Scene(), false, Vector3d::Zero(), folder.path());
  rig::RigCalibration calibration(CameraModel::Pinhole(320, 320, 1900, 1900, 159.5, 159.5));
  calibration.covariances.X_WC = 1e-8 * Eigen::MatrixXd::Identity(6, 6);
  calibration.covariances.X_AT = 1e-4 * Eigen::MatrixXd::Identity(6, 6);
  ProbeOptions options;
  options.calibration = calibration;
  const auto session = ReadProbeSession(folder.path(), options, GoOn);
  ASSERT_TRUE(session) << session.error().text;
  EXPECT_EQ(session->perturbations.size(), 12u);
  calibration.length_unit = "m";
  options.calibration = calibration;
  const auto other = ReadProbeSession(folder.path(), options, GoOn);
  ASSERT_FALSE(other);
  EXPECT_NE(other.error().text.find("length_unit"), std::string::npos);
}

TEST(ProbeSession, APlaneIsNoBall) {
  const TemporaryFolder folder;
  WriteBallSession(Scene(), false, Vector3d::Zero(), folder.path());
  auto session = rig::ReadSession(folder.path());
  ASSERT_TRUE(session);
  session->target = PlaneShape{};
  ASSERT_TRUE(rig::WriteSession(*session, folder.path()));
  const auto probe = ReadProbeSession(folder.path(), {}, GoOn);
  ASSERT_FALSE(probe);
  EXPECT_EQ(probe.error().kind, ErrorKind::kInput);
  EXPECT_NE(probe.error().text.find("target/shape"), std::string::npos);
}

TEST(ProbeSession, CanBeStopped) {
  const TemporaryFolder folder;
  WriteBallSession(Scene(), false, Vector3d::Zero(), folder.path());
  const auto session = ReadProbeSession(folder.path(), {}, [] { return false; });
  ASSERT_FALSE(session);
  EXPECT_EQ(session.error().kind, ErrorKind::kInterrupted);
}

TEST(ProbeSession, JoinedSessionsKeepTheirPerturbations) {
  const TemporaryFolder folder;
  WriteBallSession(Scene(), false, Vector3d::Zero(), folder.path());
  ProbeOptions options;
  options.center_sigma = 0.1;
  std::vector<ProbeSession> sessions;
  for (int i = 0; i < 2; ++i) {
    auto session = ReadProbeSession(folder.path(), options, GoOn);
    ASSERT_TRUE(session);
    sessions.push_back(std::move(*session));
  }
  const ProbeInput joined = Joined(sessions);
  ASSERT_EQ(joined.views.size(), 6u);
  ASSERT_EQ(joined.perturbations.size(), 6u);
  const auto moved = [&](std::size_t perturbation, std::size_t view) {
    return joined.perturbations[perturbation].views[view].ball.center !=
           joined.views[view].ball.center;
  };
  EXPECT_TRUE(moved(0, 0));
  EXPECT_FALSE(moved(0, 3));
  EXPECT_FALSE(moved(3, 0));
  EXPECT_TRUE(moved(3, 5));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::probe
