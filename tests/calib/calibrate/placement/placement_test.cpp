// Proves: X_AT of a sphere, a board and a mesh placed at random is within 0.1 mm and 0.1 degree,
// and inside 4 sigma, at 0.3 px outline noise over a revolution; what few or wrong angles, a hidden
// part and a turned body do; the covariance's parts. Does not prove that sigmas are right on
// average: that is placement_study's. The outlines are simulated as points; pictures are
// view_of_picture_test's.
#include "calib/calibrate/placement/placement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/angles.h"
#include "tests/calib/calibrate/placement/outline_scenes.h"

namespace turnlight::calib::calibrate::placement {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

void ExpectRight(const Placement& placed, const calib::Pose& truth, bool rotation) {
  const auto error = ErrorOf(placed.X_AT, truth);
  EXPECT_LT(error.tail<3>().norm(), 0.1);
  for (int i = rotation ? 0 : 3; i < 6; ++i)
    EXPECT_LT(std::abs(error[i]), 4.0 * std::sqrt(placed.covariance(i, i))) << i;
  if (rotation) {
    EXPECT_LT(RadToDeg(error.head<3>().norm()), 0.1);
  }
}

calib::Pose SpherePlace(std::uint64_t draw) {
  calib::Pose place = RandomPlace(RandomStream(1, draw));
  place.rotation.setIdentity();
  return place;
}

TEST(PlaceTarget, FindsASphere) {
  const auto rig = SampleRig();
  for (std::uint64_t draw = 0; draw < 3; ++draw) {
    const calib::Pose truth = SpherePlace(draw);
    const auto placed =
        PlaceTarget(rig, calib::SphereShape{30.0},
                    Outlines(rig, calib::SphereShape{30.0}, truth, Revolution(8), {}, draw), {});
    ASSERT_TRUE(placed) << placed.error().text;
    ExpectRight(*placed, truth, false);
    EXPECT_NEAR(placed->rms, 0.3, 0.02);
    EXPECT_EQ(placed->X_AT.rotation, Eigen::Matrix3d::Identity());
  }
}

TEST(PlaceTarget, FindsTheRadiusIfAsked) {
  const auto rig = SampleRig();
  const calib::Pose truth = SpherePlace(4);
  const auto views = Outlines(rig, calib::SphereShape{30.0}, truth, Revolution(8), {}, 4);
  PlacementOptions options;
  options.fit_radius = true;
  const auto placed = PlaceTarget(rig, calib::SphereShape{25.0}, views, {}, options);
  ASSERT_TRUE(placed) << placed.error().text;
  ExpectRight(*placed, truth, false);
  EXPECT_LT(std::abs(placed->radius - 30.0), 3.0 * placed->radius_sigma);
  // An edge offset of 0.2 px is nearly a radius: only that the distance changes tells them apart.
  EXPECT_LT(placed->radius_sigma, 0.2 * placed->pixel_length);
  EXPECT_GT(placed->radius_sigma, 0.1 * placed->pixel_length);
  const auto one = PlaceTarget(rig, calib::SphereShape{25.0}, {views[0]}, {}, options);
  ASSERT_FALSE(one);
  EXPECT_THAT(one.error().text,
              AllOf(HasSubstr("the radius cannot be told"), HasSubstr("without --fit-radius")));
}

TEST(PlaceTarget, OneAngleIsReportedWithItsTrueSigma) {
  const auto rig = SampleRig();
  const calib::Pose truth = SpherePlace(5);
  const auto placed =
      PlaceTarget(rig, calib::SphereShape{30.0},
                  Outlines(rig, calib::SphereShape{30.0}, truth, {20.0}, {}, 5), {});
  ASSERT_TRUE(placed) << placed.error().text;
  EXPECT_THAT(placed->remarks, Contains(HasSubstr("one angle only")));
  // 0.2 px of 146 px at 400 mm.
  EXPECT_NEAR(std::sqrt(placed->covariance.bottomRightCorner<3, 3>().trace()), 0.55, 0.1);
}

TEST(PlaceTarget, FindsABoardByItsCorners) {
  const auto rig = SampleRig();
  const calib::PlaneShape board{70.0, 50.0, 1};
  const calib::Pose truth = RandomPlace(RandomStream(2, 1));
  const auto placed =
      PlaceTarget(rig, board, Outlines(rig, board, truth, Revolution(8), {}, 1), {});
  ASSERT_TRUE(placed) << placed.error().text;
  const calib::Pose half = truth * calib::Turn(Eigen::Vector3d::UnitZ(), std::numbers::pi);
  ExpectRight(*placed, truth.rotation(0, 0) > 0.0 ? truth : half, true);
  EXPECT_THAT(placed->remarks, Contains(HasSubstr("which of its sides")));
}

TEST(PlaceTarget, PickedPointsAlonePlaceABoard) {
  const auto rig = SampleRig();
  calib::MeshShape corners;
  corners.vertices = {{-35, -25, 0}, {35, -25, 0}, {35, 25, 0}, {-35, 25, 0}, {10, 5, 0}};
  const calib::Pose truth = RandomPlace(RandomStream(2, 7));
  const std::vector<View> views{{0.0, "frame 0", {}}};
  const auto placed =
      PlaceTarget(rig, calib::PlaneShape{70.0, 50.0, 1}, views, Pick(rig, corners, truth, 0.3));
  ASSERT_TRUE(placed) << placed.error().text;
  const auto error = ErrorOf(placed->X_AT, truth);
  for (int i = 0; i < 6; ++i)
    EXPECT_LT(std::abs(error[i]), 3.0 * std::sqrt(placed->covariance(i, i))) << i;
}

TEST(PlaceTarget, FindsAMeshFromAFewPickedPoints) {
  const auto rig = SampleRig();
  const calib::MeshShape lump = Lump();
  const calib::Pose truth = RandomPlace(RandomStream(3, 1));
  const auto placed = PlaceTarget(rig, lump, Outlines(rig, lump, truth, Revolution(8), {}, 2),
                                  Pick(rig, lump, truth, 2.0));
  ASSERT_TRUE(placed) << placed.error().text;
  ExpectRight(*placed, truth, true);
}

TEST(PlaceTarget, FindsAnUprightMeshWithoutPoints) {
  const auto rig = SampleRig();
  const calib::MeshShape lump = Lump();
  const calib::Pose truth = RandomPlace(RandomStream(3, 2), 3.0);
  const auto views = Outlines(rig, lump, truth, Revolution(6), {}, 3);
  PlacementOptions options;
  options.upright = true;
  const auto placed = PlaceTarget(rig, lump, views, {}, options);
  ASSERT_TRUE(placed) << placed.error().text;
  ExpectRight(*placed, truth, true);
  const auto refused = PlaceTarget(rig, lump, views, {});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().text,
              AllOf(HasSubstr("picked points to begin with (--points"), HasSubstr("--upright")));
}

TEST(PlaceTarget, SaysThatATurnedBodysRotationIsNotDetermined) {
  const auto rig = SampleRig();
  const calib::MeshShape vase = Vase();
  const calib::Pose truth = RandomPlace(RandomStream(3, 3));
  const auto placed = PlaceTarget(rig, vase, Outlines(rig, vase, truth, Revolution(6), {}, 4),
                                  Pick(rig, vase, truth, 2.0));
  ASSERT_TRUE(placed) << placed.error().text;
  ASSERT_TRUE(placed->symmetry_axis);
  EXPECT_GT(std::abs(placed->symmetry_axis->z()), 0.999);
  const Eigen::Vector3d axis_A = placed->X_AT.rotation.col(2);
  EXPECT_GT(axis_A.dot(placed->covariance.topLeftCorner<3, 3>() * axis_A), 3.0);
  EXPECT_LT(RadToDeg(std::acos(std::min(1.0, axis_A.dot(truth.rotation.col(2))))), 0.1);
  EXPECT_THAT(placed->remarks, Contains(HasSubstr("not determined")));
}

TEST(PlaceTarget, LeavesOutAHiddenPart) {
  const auto rig = SampleRig();
  const calib::Pose truth = SpherePlace(6);
  auto views = Outlines(rig, calib::SphereShape{30.0}, truth, Revolution(6), {}, 6);
  for (std::size_t i = 0; i < views[2].outline.size() / 4; ++i)
    views[2].outline[i].pixel += (3.0 + 0.2 * static_cast<double>(i)) * views[2].outline[i].normal;
  const auto placed = PlaceTarget(rig, calib::SphereShape{30.0}, views, {});
  ASSERT_TRUE(placed) << placed.error().text;
  ExpectRight(*placed, truth, false);
  EXPECT_THAT(placed->remarks, Contains(HasSubstr("frame 2: 2")));
}

TEST(PlaceTarget, SaysThatTheTableTurnsTheOtherWay) {
  const auto rig = SampleRig();
  const calib::Pose truth = SpherePlace(7);
  auto views = Outlines(rig, calib::SphereShape{30.0}, truth, Revolution(6), {}, 7);
  for (View& view : views) view.angle_deg = -view.angle_deg;
  const auto placed = PlaceTarget(rig, calib::SphereShape{30.0}, views, {});
  ASSERT_FALSE(placed);
  EXPECT_THAT(placed.error().text, HasSubstr("turns against"));
}

TEST(PlaceTarget, CorrelatedNoiseWidensTheCovariance) {
  const auto rig = SampleRig();
  const calib::Pose truth = SpherePlace(8);
  const auto place = [&](double correlation) {
    return PlaceTarget(
        rig, calib::SphereShape{30.0},
        Outlines(rig, calib::SphereShape{30.0}, truth, Revolution(6), {0.3, correlation, 0.0}, 8),
        {}, {.common_shift_sigma = 0.0});
  };
  const auto white = place(0.0), red = place(0.8);
  ASSERT_TRUE(white && red);
  EXPECT_NEAR(white->correlation, 1.0, 0.2);
  // Every second point is used: neighbours have 0.64, and (1 + 0.64) / (1 - 0.64) is 4.6.
  EXPECT_NEAR(red->correlation, 4.6, 1.0);
  EXPECT_NEAR(red->covariance(3, 3) / white->covariance(3, 3), 4.6, 1.2);
}

TEST(PlaceTarget, TheCalibrationsSigmaGoesOn) {
  auto rig = SampleRig();
  const calib::Pose truth = SpherePlace(9);
  const auto views = Outlines(rig, calib::SphereShape{30.0}, truth, Revolution(6), {}, 9);
  // The axis's shift is known to 0.05 mm in each direction.
  rig.covariances.X_WA = Eigen::MatrixXd::Zero(6, 6);
  rig.covariances.X_WA->bottomRightCorner(3, 3).diagonal().setConstant(0.05 * 0.05);
  const auto placed = PlaceTarget(rig, calib::SphereShape{30.0}, views, {});
  ASSERT_TRUE(placed);
  // What is not along the axis moves round with the table: the mean of it over a revolution is 0.
  // A shift towards the camera, 35 degrees above, looks like one of tan(35 deg) of it along the
  // axis.
  EXPECT_NEAR(std::sqrt(placed->from_calibration(5, 5)), 0.05 / std::cos(DegToRad(35.0)), 0.004);
  EXPECT_LT(std::sqrt(placed->from_calibration(3, 3)), 0.02);
  const rig::RigCalibration with = WithTarget(rig, *placed);
  ASSERT_TRUE(with.covariances.joint);
  EXPECT_EQ(with.covariances.joint->of, (std::vector<std::string>{"X_WA", "X_AT"}));
  // An axis that is taken to be too high has the target too low on it.
  EXPECT_NEAR(with.covariances.joint->matrix(11, 5), -0.05 * 0.05, 0.0003);
}

TEST(PlaceTarget, RefusesWhatCannotTell) {
  const auto rig = SampleRig();
  const calib::PlaneShape board{70.0, 50.0, 1};
  const std::vector<View> views{{0.0, "frame 0", {}}};
  const auto nothing = PlaceTarget(rig, board, views, {});
  ASSERT_FALSE(nothing);
  EXPECT_THAT(nothing.error().text, HasSubstr("no points are picked"));
  const std::vector<PickedPoint> three(3, PickedPoint{0, {600, 400}, {0, 0, 0}, "p:1"});
  const auto few = PlaceTarget(rig, board, views, three);
  ASSERT_FALSE(few);
  EXPECT_THAT(few.error().text, HasSubstr("3 points are picked"));
  std::vector<PickedPoint> line;
  for (int i = 0; i < 4; ++i) line.push_back({0, {600.0 + i, 400}, {1.0 * i, 0, 0}, "p:1"});
  const auto straight = PlaceTarget(rig, board, views, line);
  ASSERT_FALSE(straight);
  EXPECT_THAT(straight.error().text, HasSubstr("lie on one line"));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::placement
