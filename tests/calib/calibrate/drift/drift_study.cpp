// Proves, over 200 calibrations with noise and a check of each that did not drift: no more alarms
// than are stated, and that the single causes' quantities lie within their sigmas as often as
// normal errors do. Does not prove anything of real pictures.
#include <gtest/gtest.h>

#include <cstdio>
#include <map>

#include "calib/calibrate/drift/drift.h"
#include "tests/calib/calibrate/drift/drift_scenes.h"
#include "tests/calib/calibrate/placement/outline_scenes.h"

namespace turnlight::calib::calibrate::drift {
namespace {

constexpr int kDraws = 200;

TEST(DriftStudy, FalseAlarmsOfABoard) {
  int alarms = 0;
  std::map<std::string, int> within;
  for (int draw = 0; draw < kDraws; ++draw) {
    const auto seed = static_cast<std::uint64_t>(1000 + draw);
    const axis::SimulatedTable table = NoisyBoardTable(seed);
    const auto report =
        CheckWithBoard(CalibratedOn(table), table.board,
                       axis::SimulateViews(LaterThan(table, seed + 5000), {10, 130, 250}));
    ASSERT_TRUE(report) << report.error().text;
    alarms += report->verdict != Verdict::kStillTrue;
    for (const Finding& finding : report->alone)
      for (const Quantity& quantity : finding.quantities)
        if (quantity.key == "angle_scale_deg_per_turn" || quantity.key == "focal_length_percent")
          within[quantity.key] += std::abs(quantity.value) < quantity.sigma;
  }
  std::printf("alarms %d of %d\n", alarms, kDraws);
  // Of 2 that are expected at most: no more than 99.9 % of such studies have.
  EXPECT_LE(alarms, 7);
  for (const auto& [key, count] : within) {
    std::printf("%s within a sigma: %d\n", key.c_str(), count);
    EXPECT_NEAR(count, 0.683 * kDraws, 3.3 * std::sqrt(0.683 * 0.317 * kDraws)) << key;
  }
}

TEST(DriftStudy, FalseAlarmsOfASphere) {
  int alarms = 0;
  const rig::RigCalibration rig = PlacedRig();
  for (int draw = 0; draw < kDraws; ++draw) {
    const auto views = placement::Outlines(rig, SphereShape{30.0}, rig.geometry.X_AT, {0, 120, 240},
                                           {0.3, 0.5, 0.05}, static_cast<std::uint64_t>(draw));
    const auto report = CheckWithOutlines(rig, SphereShape{30.0}, views);
    ASSERT_TRUE(report) << report.error().text;
    alarms += report->verdict != Verdict::kStillTrue;
  }
  std::printf("alarms %d of %d\n", alarms, kDraws);
  EXPECT_LE(alarms, 7);
}

}  // namespace
}  // namespace turnlight::calib::calibrate::drift
