// Rendered boards for the tests of detection, and how far what was found is from the truth.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "base/format.h"
#include "calib/calibrate/board/detect_boards.h"
#include "calib/calibrate/board/number_lattice.h"
#include "rig/sim/board_picture.h"

namespace turnlight::calib::calibrate::board {

inline Board Chessboard(int columns, int rows) {
  return {BoardKind::kChessboard, columns, rows, 20.0, 0.0, ""};
}

// 800 x 600 pixels, a strong lens if k1 is far from 0.
inline CameraModel TestCamera(double k1 = -0.1) {
  return *CameraModel::FromString(
      "{'lensmodel': 'LENSMODEL_OPENCV4', 'intrinsics': [700, 700, 399.5, 299.5, " +
          NumberText(k1) +
          ", 0.02, 0.001, -0.001], 'extrinsics': [0, 0, 0, 0, 0, 0], 'imagersize': [800, 600]}",
      "test camera");
}

struct View {
  double tilt_deg = 20.0;  // against the picture, about an axis in it
  double axis_deg = 30.0;  // of that axis, against the picture's x
  double roll_deg = 0.0;   // in the board's plane
  double distance = 450.0;
  double right = 0.0;  // of its middle
};

// A board whose middle is before the camera.
inline rig::sim::PlacedBoard Place(const Board& board, const View& view) {
  const auto radians = [](double degrees) { return degrees * std::numbers::pi / 180.0; };
  const Eigen::Vector3d axis(std::cos(radians(view.axis_deg)), std::sin(radians(view.axis_deg)), 0);
  Pose X_CB;
  X_CB.rotation = (Eigen::AngleAxisd(radians(view.tilt_deg), axis) *
                   Eigen::AngleAxisd(radians(view.roll_deg), Eigen::Vector3d::UnitZ()))
                      .toRotationMatrix();
  const Eigen::Vector3d middle((board.columns - 1) * board.spacing / 2.0,
                               (board.rows - 1) * board.spacing / 2.0, 0.0);
  X_CB.translation = Eigen::Vector3d(view.right, 0.0, view.distance) - X_CB.rotation * middle;
  return {board, X_CB, board.spacing / 2.0};
}

struct Misfit {
  double median = std::numeric_limits<double>::infinity();
  double worst = std::numeric_limits<double>::infinity();
};

// Pixels from the truth, for the numbering that looks the same and fits best.
inline Misfit MisfitOf(const BoardView& view, const rig::sim::PlacedBoard& placed,
                       const CameraModel& camera) {
  const auto truth = rig::sim::BoardPixels(placed, camera);
  Misfit best;
  for (const auto& way : SameLookingNumberings(placed.board)) {
    std::vector<double> off;
    for (const SeenPoint& seen : view.points)
      off.push_back((seen.pixel - truth[way[seen.point]]).norm());
    std::sort(off.begin(), off.end());
    if (!off.empty() && off[off.size() / 2] < best.median) best = {off[off.size() / 2], off.back()};
  }
  return best;
}

}  // namespace turnlight::calib::calibrate::board
