// A simulated rig for tests: corners of a board that turns on a table, by projecting.
#pragma once

#include <cstdint>
#include <vector>

#include "calib/calibrate/axis/calibrate_axis.h"
#include "calib/rig_geometry.h"

namespace turnlight::calib::calibrate::axis {

struct SimulatedTable {
  board::Board board;
  CameraModel camera = CameraModel::Pinhole(1600, 1200, 1800.0, 1802.0, 801.0, 597.0);
  TurntableGeometry geometry;  // X_AT is the board's place
  double backlash_deg = 0.0;   // rising angles fall short by half of it, falling ones go beyond
  double corner_noise_px = 0.0, angle_noise_deg = 0.0;
  bool numbers_anyhow = false;  // point 0 is any of the corners that look the same
  std::uint64_t seed = 1;
};

// A board flat on the table 40 mm off the axis, seen from 480 mm at 35 degrees, W as the
// calibration will have it.
SimulatedTable TableWithBoard();

// One view at each angle, the direction of approach from their order; points outside of the
// picture are not seen.
std::vector<AxisView> SimulateViews(const SimulatedTable& table,
                                    const std::vector<double>& angles_deg);
std::vector<double> Angles(double first, double step, int count);

// The errors in degrees and length units, each along W's x and y, at the calibration's origin.
struct AxisError {
  Eigen::Vector2d direction_deg, offset;
};
AxisError ErrorOf(const AxisCalibration& found, const SimulatedTable& table);
// Of a vector with a covariance.
double SquaredSigmas(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance);
// X_WC's error as its covariance tells it, W of the truth as the calibration chooses it.
Eigen::Matrix<double, 6, 1> CameraError(const AxisCalibration& found, const SimulatedTable& table);

}  // namespace turnlight::calib::calibrate::axis
