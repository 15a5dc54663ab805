// Proves, on corners that are projected and made noisy: the axis, the camera's place, the scale,
// the backlash and the closure come back within their sigmas whichever corner of a chessboard is
// numbered first and whichever way the table counts; wrong points and wrong views are left out and
// named; intrinsics' errors are in the covariance; what the views cannot determine is refused with
// the reason, or told with a large sigma that holds. Does not prove: coverage of the sigmas
// (axis_study), or that detection finds boards.
#include "calib/calibrate/axis/calibrate_axis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "base/angles.h"
#include "tests/calib/calibrate/axis/turning_board.h"

namespace turnlight::calib::calibrate::axis {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// Corners to 0.3 px, angles to 0.05 degrees.
SimulatedTable NoisyTable() {
  SimulatedTable table = TableWithBoard();
  table.corner_noise_px = 0.3;
  table.angle_noise_deg = 0.05;
  table.numbers_anyhow = true;
  return table;
}

// The board's middle on the axis.
void PutOnAxis(SimulatedTable& table) {
  Pose& X_AT = table.geometry.X_AT;
  X_AT.translation.setZero();
  X_AT.translation = -(X_AT * (0.5 * BoardPoints(table.board).back()));
}

Result<AxisCalibration> Calibrate(const SimulatedTable& table, const std::vector<double>& angles) {
  return CalibrateAxis(table.board, table.camera, SimulateViews(table, angles));
}

void ExpectWithinSigmas(const AxisCalibration& found, const SimulatedTable& table, double sigmas) {
  const AxisError error = ErrorOf(found, table);
  Eigen::Vector4d both;
  both << DegToRad(1.0) * error.direction_deg, error.offset;
  EXPECT_LT(SquaredSigmas(both.head<2>(), found.axis_covariance.topLeftCorner<2, 2>()),
            sigmas * sigmas);
  EXPECT_LT(SquaredSigmas(both.tail<2>(), found.axis_covariance.bottomRightCorner<2, 2>()),
            sigmas * sigmas);
  EXPECT_LT(std::abs(found.angle_scale - table.geometry.angle_scale), sigmas * found.scale_sigma);
}

TEST(CalibrateAxis, FindsTheAxisOfANoisyRig) {
  SimulatedTable table = NoisyTable();
  table.geometry.angle_scale = 1.0007;
  table.seed = 3;
  const auto found = Calibrate(table, Angles(0, 10, 37));
  ASSERT_TRUE(found) << found.error().text;
  const AxisError error = ErrorOf(*found, table);
  EXPECT_LT(error.direction_deg.norm(), 0.02);
  EXPECT_LT(error.offset.norm(), 0.05);
  ExpectWithinSigmas(*found, table, 3.0);
  const auto camera = CameraError(*found, table);
  for (const int i : {0, 1, 2, 3, 5})
    EXPECT_LT(std::abs(camera[i]), 3.0 * std::sqrt(found->covariance(i, i))) << i;
  EXPECT_EQ(found->X_WC.translation.y(), 0.0);
  EXPECT_NEAR(found->covariance(4, 4), 0.0, 1e-12);
  EXPECT_NEAR(found->corner_sigma_px, 0.3, 0.01);
  EXPECT_NEAR(found->angle_sigma_deg, 0.05, 0.02);
  EXPECT_EQ(found->used, 37u);
  EXPECT_FALSE(found->backlash);
  ASSERT_EQ(found->closures.size(), 1u);
  EXPECT_EQ(found->closures[0].last, 36u);
  EXPECT_NEAR(found->closures[0].turned_deg, 0.0007 * 360.0, 0.3);
  // It is the board's middle that turns by that.
  EXPECT_NEAR(found->closures[0].shift,
              DegToRad(std::abs(found->closures[0].turned_deg)) *
                  (table.geometry.X_AT * Eigen::Vector3d(45, 45, 0)).norm(),
              0.05);
}

TEST(CalibrateAxis, IsExactWithoutNoise) {
  SimulatedTable table = TableWithBoard();
  table.numbers_anyhow = true;
  table.geometry.angle_scale = 0.93;
  const auto found = Calibrate(table, Angles(-40, 10, 30));
  ASSERT_TRUE(found) << found.error().text;
  EXPECT_LT(ErrorOf(*found, table).direction_deg.norm(), 1e-6);
  EXPECT_LT(ErrorOf(*found, table).offset.norm(), 1e-6);
  EXPECT_LT(CameraError(*found, table).norm(), 1e-6);
  EXPECT_NEAR(found->angle_scale, 0.93, 1e-9);
}

TEST(CalibrateAxis, ATableThatCountsClockwiseHasANegativeScale) {
  SimulatedTable table = NoisyTable();
  table.geometry.angle_scale = -1.0;
  const auto found = Calibrate(table, Angles(0, 15, 24));
  ASSERT_TRUE(found) << found.error().text;
  ExpectWithinSigmas(*found, table, 3.5);
}

TEST(CalibrateAxis, BothWaysOfApproachTellTheBacklash) {
  SimulatedTable table = NoisyTable();
  table.backlash_deg = 0.4;
  std::vector<double> angles = Angles(0, 20, 19);
  for (const double angle : Angles(350, -20, 18)) angles.push_back(angle);
  const auto found = Calibrate(table, angles);
  ASSERT_TRUE(found) << found.error().text;
  ASSERT_TRUE(found->backlash);
  EXPECT_LT(found->backlash->sigma_deg, 0.03);
  EXPECT_NEAR(found->backlash->deg, 0.4, 3.0 * found->backlash->sigma_deg);
  ExpectWithinSigmas(*found, table, 3.5);
}

TEST(CalibrateAxis, LeavesOutWhatIsWrongAndSaysWhy) {
  const SimulatedTable table = NoisyTable();
  auto views = SimulateViews(table, Angles(0, 10, 36));
  views[5].board.points.clear();
  views[6].board.points.resize(5);
  for (std::size_t i = 0; i < 20; ++i) views[9].board.points[i].pixel.x() += 40.0;
  for (board::SeenPoint& seen : views[12].board.points) seen.pixel.x() += 15.0;
  views[20].angle_deg += 3.0;
  views[30].angle_deg += 40.0;
  const auto found = CalibrateAxis(table.board, table.camera, views);
  ASSERT_TRUE(found) << found.error().text;
  EXPECT_EQ(found->used, 31u);
  EXPECT_EQ(found->views[5].why_not, "no board was found");
  EXPECT_EQ(found->views[6].why_not, "only 5 points of the board were found");
  EXPECT_TRUE(found->views[9].used);
  EXPECT_EQ(found->views[9].outliers, 20u);
  EXPECT_THAT(found->views[12].why_not, HasSubstr("do not fit the other views"));
  EXPECT_THAT(found->views[20].why_not, HasSubstr("degrees away from where the others"));
  EXPECT_THAT(found->views[30].why_not, HasSubstr("degrees away from where the others"));
  ExpectWithinSigmas(*found, table, 3.5);
}

TEST(CalibrateAxis, ABoardThatStandsIsSeenOverAPartOfATurn) {
  SimulatedTable table = NoisyTable();
  table.geometry.X_AT = Turn(Eigen::Vector3d::UnitZ(), DegToRad(90.0)) *
                        Turn(Eigen::Vector3d::UnitX(), DegToRad(-90.0));
  table.geometry.X_AT.translation = {30.0, -45.0, 100.0};
  const auto found = Calibrate(table, Angles(-60, 5, 25));
  ASSERT_TRUE(found) << found.error().text;
  EXPECT_FALSE(found->board_lies);
  ExpectWithinSigmas(*found, table, 3.5);
  EXPECT_NEAR(found->arc_deg, 120.0, 1e-9);
}

TEST(CalibrateAxis, AnErrorOfTheIntrinsicsIsInTheCovariance) {
  SimulatedTable table = TableWithBoard();
  table.corner_noise_px = 0.01;
  const auto views = SimulateViews(table, Angles(0, 10, 36));
  // A lens that is off by what its covariance says.
  const Eigen::Vector4d sigma(4.0, 4.0, 3.0, 3.0);
  std::vector<double> intrinsics = table.camera.intrinsics();
  const Eigen::Vector4d off = sigma.cwiseProduct(Eigen::Vector4d(1.0, 1.0, -0.8, 0.6));
  for (std::size_t i = 0; i < 4; ++i) intrinsics[i] += off[static_cast<Eigen::Index>(i)];
  const CameraModel camera = table.camera.WithIntrinsics(intrinsics);
  AxisOptions options;
  options.intrinsics_covariance = sigma.cwiseAbs2().asDiagonal().toDenseMatrix();
  const auto found = CalibrateAxis(table.board, camera, views, options);
  ASSERT_TRUE(found) << found.error().text;
  ASSERT_TRUE(found->joint_covariance);
  ASSERT_EQ(found->joint_covariance->rows(), 11);
  // What X_WC is off by follows from what the intrinsics are off by.
  const Eigen::MatrixXd cross = found->joint_covariance->bottomLeftCorner(7, 4);
  const Eigen::VectorXd expected = cross * options.intrinsics_covariance->inverse() * off;
  const auto camera_error = CameraError(*found, table);
  EXPECT_GT(camera_error.tail<3>().norm(), 0.5);
  EXPECT_LT((camera_error.tail<3>() - expected.segment<3>(3)).norm(),
            0.1 * camera_error.tail<3>().norm());
  EXPECT_LT((camera_error.head<3>() - expected.head<3>()).norm(),
            0.1 * camera_error.head<3>().norm());
  options.intrinsics_covariance = Eigen::MatrixXd::Identity(3, 3);
  EXPECT_THAT(CalibrateAxis(table.board, camera, views, options).error().text,
              HasSubstr("3 x 3, allowed is the camera model's, 4 x 4"));
}

TEST(CalibrateAxis, ABoardOnTheAxisWillDo) {
  SimulatedTable table = NoisyTable();
  PutOnAxis(table);
  const auto found = Calibrate(table, Angles(0, 10, 36));
  ASSERT_TRUE(found) << found.error().text;
  ExpectWithinSigmas(*found, table, 3.5);
  // A tiny one too, but its sigmas are ten times as large.
  table.board.spacing = 1.0;
  PutOnAxis(table);
  const auto tiny = Calibrate(table, Angles(0, 10, 36));
  ASSERT_TRUE(tiny) << tiny.error().text;
  EXPECT_GT(tiny->direction_sigma_deg, 5.0 * found->direction_sigma_deg);
  ExpectWithinSigmas(*tiny, table, 3.5);
}

TEST(CalibrateAxis, AFewDegreesHaveALargeSigmaOrAreRefused) {
  const SimulatedTable table = NoisyTable();
  const auto found = Calibrate(table, Angles(0, 2, 10));
  ASSERT_TRUE(found) << found.error().text;
  EXPECT_GT(found->direction_sigma_deg, 0.05);
  EXPECT_GT(found->scale_sigma, 1e-3);
  ExpectWithinSigmas(*found, table, 3.5);
  const auto refused = Calibrate(table, Angles(0, 0.2, 10));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kNoEstimate);
  EXPECT_THAT(refused.error().text, AllOf(HasSubstr("the views do not determine the axis: sigma"),
                                          HasSubstr("the views span 1.8 degrees of a turn")));
}

TEST(CalibrateAxis, TooFewAnglesAreRefused) {
  const SimulatedTable table = NoisyTable();
  EXPECT_THAT(Calibrate(table, {0, 70}).error().text,
              HasSubstr("2 of 2 views can be used, allowed are at least 5"));
  EXPECT_THAT(Calibrate(table, {0, 70, 0, 70, 0, 70, 360, 430}).error().text,
              HasSubstr("they are at 2 different angles, allowed are at least 3"));
  EXPECT_THAT(CalibrateAxis(table.board, table.camera, {}).error().text, HasSubstr("0 of 0 views"));
}

TEST(CalibrateAxis, RightAnglesDoNotTellWhichWayASquareBoardOnTheAxisTurns) {
  SimulatedTable table = NoisyTable();
  PutOnAxis(table);
  const auto refused = Calibrate(table, {0, 90, 180, 270, 360, 450});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().text, AllOf(HasSubstr("it looks the same from 4 sides"),
                                          HasSubstr("no multiples of 45 degrees apart")));
}

TEST(CalibrateAxis, PicturesInAnotherOrderAreRefused) {
  const SimulatedTable table = NoisyTable();
  auto views = SimulateViews(table, Angles(0, 10, 36));
  for (std::size_t i = 0; i < views.size(); ++i) views[i].angle_deg = 10.0 * ((i * 17 + 5) % 36);
  const auto refused = CalibrateAxis(table.board, table.camera, views);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kNoEstimate);
  EXPECT_THAT(refused.error().text, HasSubstr("do not show one board that turns about one axis"));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::axis
