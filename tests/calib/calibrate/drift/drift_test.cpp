// Proves, on corners and outlines that are projected and made noisy, against a calibration that was
// itself made with noise: what did not drift is called true, a board that lies elsewhere included;
// a camera that moved by 0.2 mm or turned by 0.05 degree, another focus, angles with another scale
// and a target that was put down again are found, named and measured within their sigmas; what
// looks the same is said to fit as well; what pictures cannot tell is said. Does not prove: the
// rate of false alarms to its last digit (drift_study), or anything of real pictures.
#include "calib/calibrate/drift/drift.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/calibrate/drift/drift_json.h"
#include "calib/calibrate/drift/drift_words.h"
#include "tests/calib/calibrate/drift/drift_scenes.h"
#include "tests/calib/calibrate/placement/outline_scenes.h"

namespace turnlight::calib::calibrate::drift {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const axis::SimulatedTable& Table() {
  static const axis::SimulatedTable table = NoisyBoardTable(3);
  return table;
}

const rig::RigCalibration& Stored() {
  static const rig::RigCalibration rig = CalibratedOn(Table());
  return rig;
}

DriftReport CheckedOn(const axis::SimulatedTable& later,
                      const std::vector<double>& angles = {10, 130, 250}) {
  const auto report = CheckWithBoard(Stored(), later.board, axis::SimulateViews(later, angles));
  EXPECT_TRUE(report) << report.error().text;
  return report ? *report : DriftReport();
}

Quantity Named(const Finding& finding, const std::string& key) {
  for (const Quantity& quantity : finding.quantities)
    if (quantity.key == key) return quantity;
  ADD_FAILURE() << "no " << key;
  return {};
}

bool Has(const std::vector<Finding>& findings, Cause cause) {
  for (const Finding& finding : findings)
    if (finding.causes == std::vector{cause}) return true;
  return false;
}

void ExpectFound(const DriftReport& report, Cause cause) {
  EXPECT_EQ(report.verdict, Verdict::kDrifted) << DriftText(report);
  EXPECT_EQ(report.found.causes, std::vector{cause}) << DriftText(report);
}

void ExpectNear(const Quantity& quantity, double truth) {
  EXPECT_NEAR(quantity.value, truth, 4.0 * quantity.sigma) << quantity.key;
}

TEST(DriftOfABoard, WhatDidNotDriftIsTrueWhereverTheBoardLies) {
  int alarms = 0;
  for (std::uint64_t seed = 100; seed < 140; ++seed)
    alarms += CheckedOn(LaterThan(Table(), seed)).verdict != Verdict::kStillTrue;
  EXPECT_LE(alarms, 3);
  const DriftReport report = CheckedOn(LaterThan(Table(), 100));
  EXPECT_THAT(DriftText(report), AllOf(HasSubstr("still true"), HasSubstr("3 used")));
  EXPECT_NEAR(report.noise, 0.3, 0.03);
  EXPECT_LT(report.moved_rms, 0.1);
  EXPECT_TRUE(Remedies(report).empty());
}

TEST(DriftOfABoard, FindsACameraThatTurned) {
  axis::SimulatedTable later = LaterThan(Table(), 7);
  TurnCamera(later.geometry, 1, 0.05);
  const DriftReport report = CheckedOn(later);
  ExpectFound(report, Cause::kCamera);
  ExpectNear(Named(report.found, "camera_turned_deg"), 0.05);
  ExpectNear(Named(report.found, "axis_place"), 480.0 * 0.05 * 3.14159265 / 180.0);
  // An image centre that moved looks much the same.
  EXPECT_TRUE(Has(report.as_well, Cause::kLens));
  EXPECT_THAT(DriftText(report), AllOf(HasSubstr("drifted: the camera turned by 0.0"),
                                       HasSubstr("turnlight calibrate axis")));
}

TEST(DriftOfABoard, FindsACameraThatMovedWithTwoViews) {
  axis::SimulatedTable later = LaterThan(Table(), 8);
  ShiftCamera(later.geometry, 0, 0.2);
  const DriftReport report = CheckedOn(later, {20, 110});
  ExpectFound(report, Cause::kCamera);
  ExpectNear(Named(report.found, "axis_place"), 0.2);
  EXPECT_GT(report.stored_rms, 1.05 * report.noise);
}

TEST(DriftOfABoard, FindsALargeDriftToo) {
  axis::SimulatedTable later = LaterThan(Table(), 9);
  TurnCamera(later.geometry, 1, 1.0);
  ShiftCamera(later.geometry, 2, 9.0);
  const DriftReport report = CheckedOn(later);
  ExpectFound(report, Cause::kCamera);
  EXPECT_NEAR(report.noise, 0.3, 0.03);
  EXPECT_GT(report.worst, 20.0);
}

TEST(DriftOfABoard, FindsAnotherFocus) {
  axis::SimulatedTable later = LaterThan(Table(), 10);
  std::vector<double> intrinsics = later.camera.intrinsics();
  intrinsics[0] *= 1.01;
  intrinsics[1] *= 1.01;
  later.camera = later.camera.WithIntrinsics(intrinsics);
  const DriftReport report = CheckedOn(later);
  ExpectFound(report, Cause::kLens);
  ExpectNear(Named(report.found, "focal_length_percent"), 1.0);
  EXPECT_THAT(Remedies(report).front(), HasSubstr("turnlight calibrate intrinsics"));
}

TEST(DriftOfABoard, FindsAnglesOfAnotherScale) {
  axis::SimulatedTable later = LaterThan(Table(), 11);
  later.geometry.angle_scale = 1.005;
  const DriftReport report = CheckedOn(later);
  ExpectFound(report, Cause::kAngles);
  ExpectNear(Named(report.found, "angle_scale_deg_per_turn"), 1.8);
}

TEST(DriftOfABoard, TwoThingsAtOnceAreBothFound) {
  axis::SimulatedTable later = LaterThan(Table(), 12);
  later.geometry.angle_scale = 1.01;
  TurnCamera(later.geometry, 0, 0.2);
  const DriftReport report = CheckedOn(later);
  EXPECT_EQ(report.found.causes, (std::vector{Cause::kCamera, Cause::kAngles}))
      << DriftText(report);
}

TEST(DriftOfABoard, SaysWhatCannotBeTold) {
  const DriftReport one = CheckedOn(LaterThan(Table(), 13), {30});
  EXPECT_EQ(one.verdict, Verdict::kCannotTell);
  EXPECT_THAT(one.why, HasSubstr("at one angle of the table only"));
  // The board moved between two pictures.
  auto views = axis::SimulateViews(LaterThan(Table(), 14), {0, 90, 180});
  for (board::SeenPoint& seen : views[1].board.points) seen.pixel.x() += 60.0;
  const auto moved = CheckWithBoard(Stored(), Table().board, views);
  ASSERT_TRUE(moved);
  EXPECT_EQ(moved->verdict, Verdict::kCannotTell) << DriftText(*moved);
  EXPECT_THAT(moved->why, HasSubstr("view 1 (90 deg): most of its points"));
  const auto none = CheckWithBoard(Stored(), Table().board, {{0.0, {}, {}}});
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().text, HasSubstr("no board was found"));
}

TEST(DriftOfABoard, LeavesOutWrongPointsAndEmptyViews) {
  auto views = axis::SimulateViews(LaterThan(Table(), 15), {0, 60, 130, 250});
  for (std::size_t i = 0; i < 10; ++i) views[0].board.points[7 * i].pixel.y() += 25.0;
  views[2].board.points.clear();
  const auto report = CheckWithBoard(Stored(), Table().board, views);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->verdict, Verdict::kStillTrue) << DriftText(*report);
  EXPECT_GE(report->outliers, 10u);
  EXPECT_THAT(report->left_out, testing::ElementsAre("view 2 (130 deg): no board was found"));
}

// Outlines to 0.3 px, which go together over some points.
DriftReport CheckedWith(const rig::RigCalibration& now, const TargetShape& shape,
                        std::uint64_t seed) {
  const auto views =
      placement::Outlines(now, shape, now.geometry.X_AT, {0, 70, 150, 260}, {0.3, 0.5, 0.05}, seed);
  const auto report = CheckWithOutlines(PlacedRig(), shape, views);
  EXPECT_TRUE(report) << report.error().text;
  return report ? *report : DriftReport();
}

TEST(DriftOfATarget, WhatDidNotDriftIsTrue) {
  for (std::uint64_t seed : {1, 2, 3}) {
    const DriftReport report = CheckedWith(PlacedRig(), SphereShape{30.0}, seed);
    EXPECT_EQ(report.verdict, Verdict::kStillTrue) << DriftText(report);
  }
}

TEST(DriftOfATarget, OneThatWasPutDownElsewhereIsNoCamera) {
  rig::RigCalibration now = PlacedRig();
  now.geometry.X_AT.translation += Eigen::Vector3d(1.0, 0.5, 0.0);
  for (const TargetShape& shape :
       {TargetShape(SphereShape{30.0}), TargetShape(placement::Lump())}) {
    const DriftReport report = CheckedWith(now, shape, 4);
    ExpectFound(report, Cause::kTarget);
    ExpectNear(Named(report.found, "target_moved"), std::hypot(1.0, 0.5));
    EXPECT_FALSE(Has(report.as_well, Cause::kCamera));
    EXPECT_THAT(Remedies(report), testing::ElementsAre(HasSubstr("turnlight calibrate target")));
  }
}

TEST(DriftOfATarget, ACameraThatTurnedIsNoTarget) {
  rig::RigCalibration now = PlacedRig();
  TurnCamera(now.geometry, 1, 0.1);
  const DriftReport report = CheckedWith(now, placement::Lump(), 5);
  ExpectFound(report, Cause::kCamera);
  ExpectNear(Named(report.found, "axis_place"), 400.0 * 0.1 * 3.14159265 / 180.0);
  EXPECT_FALSE(Has(report.as_well, Cause::kTarget));
}

TEST(DriftOfATarget, WhatLooksTheSameFitsAsWell) {
  rig::RigCalibration now = PlacedRig();
  now.geometry.angle_offset_deg += 1.0;
  const DriftReport report = CheckedWith(now, placement::Lump(), 6);
  ExpectFound(report, Cause::kAngles);
  ExpectNear(Named(report.found, "angle_offset_deg"), 1.0);
  EXPECT_TRUE(Has(report.as_well, Cause::kTarget)) << DriftText(report);
}

TEST(DriftOfATarget, NeedsAPlaceAndAnOutline) {
  rig::RigCalibration rig = PlacedRig();
  const auto none = CheckWithOutlines(rig, SphereShape{30.0}, {{0.0, "frame 0", {}}});
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().text, HasSubstr("no picture shows the target's outline"));
  rig.target_placed = false;
  const auto unplaced = CheckWithOutlines(rig, SphereShape{30.0}, {});
  ASSERT_FALSE(unplaced);
  EXPECT_THAT(unplaced.error().text, HasSubstr("calibrate target"));
}

TEST(DriftReport, IsWrittenAndDrawn) {
  axis::SimulatedTable later = LaterThan(Table(), 7);
  TurnCamera(later.geometry, 1, 0.05);
  const DriftReport report = CheckedOn(later);
  EXPECT_THAT(PrintDrift(report),
              AllOf(HasSubstr("\"turnlight-check\""), HasSubstr("\"verdict\": \"drifted\""),
                    HasSubstr("\"camera_turned_deg\"")));
  const cv::Mat3b page = DrawDrift(report, {1600, 1200});
  EXPECT_GT(page.cols, 1000);
  EXPECT_EQ(page(page.rows - 1, 0), cv::Vec3b(255, 255, 255));
  // Nothing fitted can be written and drawn too.
  const DriftReport one = CheckedOn(LaterThan(Table(), 13), {30});
  EXPECT_THAT(PrintDrift(one), HasSubstr("\"noise_px\": null"));
  EXPECT_FALSE(DrawDrift(one, {1600, 1200}).empty());
}

}  // namespace
}  // namespace turnlight::calib::calibrate::drift
