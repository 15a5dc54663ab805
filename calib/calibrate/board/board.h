// A calibration board: a flat target whose points are known, and what one picture shows of it.
//
// Frame B of the board: its points lie in z = 0, x along a row, y along a column, origin at point
// 0, z = x cross y. Seen from the printed side with point 0 at the top left, x goes to the right
// and y down, so that z points into the board, away from who sees it.
#pragma once

#include <Eigen/Core>
#include <compare>
#include <cstddef>
#include <string>
#include <vector>

#include "calib/pose.h"

namespace turnlight::calib::calibrate::board {

enum class BoardKind {
  kChessboard,    // points: the inner corners
  kCharuco,       // points: the inner corners of the chessboard that its markers tell apart
  kAprilTagGrid,  // points: four corners a tag
};

// Point i of a chessboard or ChArUco board is at column i % columns and row i / columns, spacing
// apart. Tag t of a grid is at column t % columns and row t / columns; its corners are points 4 t
// to 4 t + 3, clockwise from the top left.
struct Board {
  BoardKind kind = BoardKind::kChessboard;
  int columns = 10;        // of points (of tags, for a grid), at least 2
  int rows = 10;           // likewise
  double spacing = 10.0;   // length unit; between neighbouring points; between tags' left edges
  double marker = 0.0;     // length unit; side of a marker or tag; 0 for chessboards
  std::string dictionary;  // of markers, OpenCV's name without "DICT_": "4X4_50", "APRILTAG_36h11"

  std::size_t PointCount() const {
    return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows) *
           (kind == BoardKind::kAprilTagGrid ? 4 : 1);
  }
};

// p_B of all points, by their number. z = 0.
std::vector<Eigen::Vector3d> BoardPoints(const Board& board);

// The board in a frame in the middle of its points, whose x is along its rows and whose z is out of
// its printed side, towards who looks at it.
Pose PoseInMiddle(const Board& board);

// Inner corners of a chessboard, the larger number first.
struct GridSize {
  int columns = 0, rows = 0;
  auto operator<=>(const GridSize&) const = default;
};

struct SeenPoint {
  std::size_t point = 0;                            // of the board
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // (0, 0) is the centre of the top-left pixel
  // Standard deviation relative to a well seen point, at least 1: 2 for one found at half the
  // resolution. A weight is 1 / spread.
  double spread = 1.0;
};

// One board in one picture. Which corner of a chessboard is point 0 cannot always be told: a board
// whose points are as many across as down looks the same from four sides. Then it is any of them.
struct BoardView {
  std::vector<SeenPoint> points;  // by number, each at most once
};

}  // namespace turnlight::calib::calibrate::board
