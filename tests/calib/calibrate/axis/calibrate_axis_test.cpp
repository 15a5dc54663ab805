#include "calib/calibrate/axis/calibrate_axis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/angles.h"
#include "tests/calib/calibrate/axis/turning_board.h"

namespace turnlight::calib::calibrate::axis {
namespace {

TEST(CalibrateAxis, FindsTheAxisOfANoisyRig) {
  SimulatedTable table = TableWithBoard();
  table.corner_noise_px = 0.3;
  table.angle_noise_deg = 0.05;
  table.numbers_anyhow = true;
  table.geometry.angle_scale = 1.0007;
  const auto found = CalibrateAxis(table.board, table.camera, SimulateViews(table, Angles(0, 10, 37)));
  ASSERT_TRUE(found) << found.error().text;
  const AxisError error = ErrorOf(*found, table);
  printf("dir %g %g deg (sigma %g), offset %g %g (sigma %g), scale %g (%g), px %g angle %g, backlash %d closures %zu\n",
         error.direction_deg.x(), error.direction_deg.y(), found->direction_sigma_deg, error.offset.x(), error.offset.y(), found->offset_sigma,
         found->angle_scale - 1.0007, found->scale_sigma, found->corner_sigma_px, found->angle_sigma_deg, (int)found->backlash.has_value(), found->closures.size());
  for (const auto& c : found->closures) printf("closure %g +- %g deg, %g\n", c.turned_deg, c.turned_sigma_deg, c.shift);
  std::cout << CameraError(*found, table).transpose() << "\n" << found->covariance.diagonal().cwiseSqrt().transpose() << "\n";
}

}  // namespace
}  // namespace turnlight::calib::calibrate::axis
