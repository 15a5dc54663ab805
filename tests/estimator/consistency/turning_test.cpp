// Proves that the axis and the angles of poses made from them come back, with the session's own
// angles or without, and that other poses are no turning.
#include "estimator/consistency/turning.h"

#include <gtest/gtest.h>

#include "base/angles.h"

namespace turnlight::estimator::consistency {
namespace {

using Eigen::Vector3d;

calib::RigGeometry Table(double scale = 1.0) {
  calib::TurntableGeometry table;
  table.X_WC = calib::LookAtOrigin(0.3, 0.5, 400.0);
  table.X_WA = calib::Turn(Vector3d(0.2, -0.3, 0.9).normalized(), 0.4);
  table.X_WA.translation = {5.0, -3.0, 2.0};
  table.X_AT.translation = {7.0, 1.0, 20.0};
  table.angle_scale = scale;
  table.angle_offset_deg = 12.0;
  return table;
}

std::vector<calib::RigPoses> PosesOf(const calib::RigGeometry& rig,
                                     const std::vector<double>& angles_deg) {
  std::vector<calib::RigPoses> out;
  for (const double angle : angles_deg) out.push_back(calib::PosesAt(rig, angle));
  return out;
}

std::vector<double> Steps(double first, double step, int count) {
  std::vector<double> out;
  for (int i = 0; i < count; ++i) out.push_back(first + step * i);
  return out;
}

TEST(Turning, FindsATablesAxisAndAngles) {
  const auto angles = Steps(0.0, 10.0, 36);
  const auto found = FindTurning(PosesOf(Table(), angles), angles);
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->camera_moves);
  const Vector3d axis = std::get<calib::TurntableGeometry>(Table()).X_WA.rotation.col(2);
  EXPECT_LT((found->axis - axis).norm(), 1e-9);
  const Vector3d off = found->point - Vector3d(5.0, -3.0, 2.0);
  EXPECT_LT((off - off.dot(axis) * axis).norm(), 1e-8);
  for (std::size_t k = 0; k < angles.size(); ++k)
    EXPECT_NEAR(RadToDeg(found->angle[k]), angles[k], 1e-7);
}

TEST(Turning, CountsFromTheSessionsZeroAndEitherWayRound) {
  const auto angles = Steps(-100.0, 25.0, 9);
  const auto found = FindTurning(PosesOf(Table(-1.0), angles), angles);
  ASSERT_TRUE(found);
  for (std::size_t k = 0; k < angles.size(); ++k)
    EXPECT_NEAR(std::abs(RadToDeg(found->angle[k])), std::abs(angles[k]), 1e-7);
  const auto nameless = FindTurning(PosesOf(Table(), angles), {});
  ASSERT_TRUE(nameless);
  EXPECT_NEAR(nameless->angle[0], 0.0, 1e-12);
  EXPECT_NEAR(RadToDeg(nameless->angle[8]), 200.0, 1e-7);
}

TEST(Turning, FindsACameraThatIsCarriedRound) {
  const calib::OrbitGeometry orbit{30.0, 500.0, {}};
  const auto angles = Steps(0.0, 20.0, 12);
  const auto found = FindTurning(PosesOf(orbit, angles), angles);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->camera_moves);
  EXPECT_LT((found->axis - Vector3d::UnitZ()).norm(), 1e-9);
}

TEST(Turning, TurnsAPoseToWhereAnotherAngleHasIt) {
  const auto angles = Steps(0.0, 15.0, 10);
  const auto poses = PosesOf(Table(), angles);
  const auto found = FindTurning(poses, angles);
  ASSERT_TRUE(found);
  const calib::RigPoses turned = Turned(*found, poses[2], DegToRad(45.0));
  EXPECT_LT((turned.X_WT.rotation - poses[5].X_WT.rotation).norm(), 1e-9);
  EXPECT_LT((turned.X_WT.translation - poses[5].X_WT.translation).norm(), 1e-7);
}

TEST(Turning, IsNotWhatMovesOtherwise) {
  const auto angles = Steps(0.0, 10.0, 12);
  auto lifted = PosesOf(Table(), angles);
  for (std::size_t k = 0; k < lifted.size(); ++k)
    lifted[k].X_WT.translation.z() += 3.0 * static_cast<double>(k);
  EXPECT_FALSE(FindTurning(lifted, angles));
  auto both = PosesOf(Table(), angles);
  both[3].X_WC = calib::LookAtOrigin(0.5, 0.5, 400.0);
  EXPECT_FALSE(FindTurning(both, angles));
  EXPECT_FALSE(FindTurning(PosesOf(Table(), Steps(0.0, 0.1, 12)), {}));
  EXPECT_FALSE(FindTurning(PosesOf(Table(), {0.0, 10.0}), {}));
}

}  // namespace
}  // namespace turnlight::estimator::consistency
