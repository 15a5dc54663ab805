// Proves: the words of a calibrated axis name what it found, what was left out and what is weak;
// the pictures are drawn for any calibration that there is. Does not prove: that they are
// beautiful.
#include "calib/calibrate/axis/axis_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/calib/calibrate/axis/turning_board.h"

namespace turnlight::calib::calibrate::axis {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(AxisReport, SaysWhatWasFoundInWords) {
  SimulatedTable table = TableWithBoard();
  table.corner_noise_px = 0.3;
  table.angle_noise_deg = 0.05;
  table.numbers_anyhow = true;
  table.geometry.angle_scale = -1.0;
  auto views = SimulateViews(table, Angles(0, 20, 19));
  views[3].board.points.clear();
  const auto axis = CalibrateAxis(table.board, table.camera, views);
  ASSERT_TRUE(axis) << axis.error().text;
  const std::string text = AxisText(*axis, views, "mm");
  EXPECT_THAT(text, AllOf(HasSubstr("18 of 19 used"),
                          HasSubstr("left out    view 3 (60 deg): no board was found"),
                          HasSubstr("counts clockwise seen from above"),
                          HasSubstr("numbered by the angles"), HasSubstr("not determined"),
                          HasSubstr("closure       view 18 (360 deg) against view 0 (0 deg)"),
                          HasSubstr("verdict       the axis is known to"), HasSubstr(": good")));
  EXPECT_EQ(DrawAxisViews(*axis, views).cols, 860);
  EXPECT_GT(DrawAxisPlan(*axis, table.board, "mm").rows, 200);
}

TEST(AxisReport, AWeakAxisIsCalledWeak) {
  AxisCalibration axis;
  axis.origin_C = {0.0, 0.0, 400.0};
  axis.direction_sigma_deg = 0.5;
  axis.offset_sigma = 0.01;
  axis.scale_sigma = 0.01;
  axis.arc_deg = 30.0;
  EXPECT_THAT(AxisVerdict(axis, "mm"),
              AllOf(HasSubstr("weak is its direction, the angle scale"), Not(HasSubstr("where")),
                    HasSubstr("over more of a turn")));
  axis.corner_sigma_px = 4.0;
  EXPECT_THAT(AxisVerdict(axis, "mm"), HasSubstr("is it this lens and this board"));
  axis.angle_sigma_deg = 0.5;
  EXPECT_THAT(AxisVerdict(axis, "mm"), HasSubstr("away from the angles that it reports"));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::axis
