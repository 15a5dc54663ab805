// A rig that was calibrated with noise, and pictures of it taken later, for the tests of drift.
#pragma once

#include <cstdint>
#include <vector>

#include "rig/rig_calibration.h"
#include "tests/calib/calibrate/axis/turning_board.h"

namespace turnlight::calib::calibrate::drift {

// A table with a board, corners to 0.3 px, angles to 0.05 degrees.
axis::SimulatedTable NoisyBoardTable(std::uint64_t seed);

// What `calibrate axis` finds of it, with its covariances.
rig::RigCalibration CalibratedOn(const axis::SimulatedTable& table);

// The board somewhere else on the table, and other noise.
axis::SimulatedTable LaterThan(const axis::SimulatedTable& table, std::uint64_t seed);

// The camera turned about its own axis (0 x, 1 y, 2 z), or shifted along it.
void TurnCamera(TurntableGeometry& geometry, int about, double degrees);
void ShiftCamera(TurntableGeometry& geometry, int along, double length);

// A rig with a target on it whose place is known, with covariances.
rig::RigCalibration PlacedRig();

}  // namespace turnlight::calib::calibrate::drift
