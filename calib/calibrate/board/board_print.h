// What is printed on a board: dark or bright, anywhere on its plane.
//
// A chessboard's square before point 0 (towards -x, -y) is dark. So is a ChArUco board's, whose
// markers fill the bright squares, their numbers row by row from the top left, and a tag's number
// is its place in the grid: as OpenCV prints them since version 4.7.
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <vector>

#include "base/result.h"
#include "calib/calibrate/board/board.h"

namespace turnlight::calib::calibrate::board {

// Fails (kInput) where no such board can be: fewer than two points or more than 1000 across or
// down, a spacing that is not positive and finite, a marker that does not fit its square, a
// dictionary that is unknown or has too few markers; a chessboard with markers.
Status CheckBoard(const Board& board);

class BoardPrint {
 public:
  // Of a board that CheckBoard accepts.
  explicit BoardPrint(const Board& board);

  // In B, length unit. Outside of extent() all is bright.
  bool Dark(double x, double y) const;
  // The outer edge of the squares, or of the tags.
  const Eigen::AlignedBox2d& extent() const { return extent_; }

 private:
  bool MarkerDark(std::size_t marker, double x, double y) const;

  Board board_;
  Eigen::AlignedBox2d extent_;
  std::vector<cv::Mat> markers_;  // their bits, by number
};

// The marker in the ChArUco square at (column, row), (0, 0) being the square before point 0;
// negative where the square is dark.
int CharucoMarker(const Board& board, int column, int row);

}  // namespace turnlight::calib::calibrate::board
