// Proves, over 200 draws of the noise of corners and angles: the axis's direction and place lie
// within the ellipses of one and two sigmas as often as they should, and the scale within its
// sigmas. Does not prove: anything of other rigs than this one.
#include <gtest/gtest.h>

#include <cmath>

#include "base/angles.h"
#include "tests/calib/calibrate/axis/turning_board.h"

namespace turnlight::calib::calibrate::axis {
namespace {

constexpr int kDraws = 200;
// Of a binomial count with 200 draws, by its normal approximation: 99 %.
constexpr double kBand = 2.576;

void ExpectShare(int inside, double share, const char* what) {
  const double sigma = std::sqrt(share * (1.0 - share) / kDraws);
  EXPECT_NEAR(double(inside) / kDraws, share, kBand * sigma) << what;
  std::printf("%-28s %.3f of %.3f\n", what, double(inside) / kDraws, share);
}

TEST(AxisStudy, SigmasCoverTheErrors) {
  SimulatedTable table = TableWithBoard();
  table.corner_noise_px = 0.3;
  table.angle_noise_deg = 0.05;
  table.numbers_anyhow = true;
  table.geometry.angle_scale = 1.0007;
  int direction[2] = {}, offset[2] = {}, scale[2] = {};
  for (int draw = 0; draw < kDraws; ++draw) {
    table.seed = 1000 + static_cast<std::uint64_t>(draw);
    const auto found =
        CalibrateAxis(table.board, table.camera, SimulateViews(table, Angles(0, 10, 36)));
    ASSERT_TRUE(found) << found.error().text;
    const AxisError error = ErrorOf(*found, table);
    EXPECT_LT(error.direction_deg.norm(), 0.02);
    EXPECT_LT(error.offset.norm(), 0.07);
    const double d = SquaredSigmas(DegToRad(1.0) * error.direction_deg,
                                   found->axis_covariance.topLeftCorner<2, 2>());
    const double o = SquaredSigmas(error.offset, found->axis_covariance.bottomRightCorner<2, 2>());
    const double s = std::abs(found->angle_scale - 1.0007) / found->scale_sigma;
    for (int sigmas = 1; sigmas <= 2; ++sigmas) {
      direction[sigmas - 1] += d < sigmas * sigmas;
      offset[sigmas - 1] += o < sigmas * sigmas;
      scale[sigmas - 1] += s < sigmas;
    }
  }
  ExpectShare(direction[0], 0.3935, "direction within 1 sigma");
  ExpectShare(direction[1], 0.8647, "direction within 2 sigmas");
  ExpectShare(offset[0], 0.3935, "offset within 1 sigma");
  ExpectShare(offset[1], 0.8647, "offset within 2 sigmas");
  ExpectShare(scale[0], 0.6827, "scale within 1 sigma");
  ExpectShare(scale[1], 0.9545, "scale within 2 sigmas");
}

}  // namespace
}  // namespace turnlight::calib::calibrate::axis
