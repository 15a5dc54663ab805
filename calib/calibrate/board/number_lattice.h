// Which point of a chessboard each corner of a lattice is.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calib/calibrate/board/board.h"
#include "calib/calibrate/board/corner_lattice.h"
#include "calib/pose.h"

namespace turnlight::calib::calibrate::board {

// The lattice of a chessboard turned and placed so that corner (column, row) is point
// row * columns + column of the board: the square before point 0 is dark if there is a turn for
// which it is; of several such turns, that with point 0 furthest to the top left of the picture.
// Where rows or columns are missing, the lattice must reach an end of the print that shows in the
// picture (CV_32F).
struct Numbering {
  std::optional<CornerLattice> lattice;
  std::string why_not;            // in words: another size of grid, or no end in sight
  std::optional<GridSize> other;  // the lattice's size, if the board's is another
};
Numbering NumberLattice(const cv::Mat& picture, const CornerLattice& lattice, const Board& board);

// Every way to number a chessboard's points that looks the same, the identity first: way[i] is the
// point that is where point i was, after a turn that the colours of its squares allow. Four for 10
// x 10, two for 7 x 7 or 8 x 6, one for 9 x 6 and for boards with markers.
std::vector<std::vector<std::size_t>> SameLookingNumberings(const Board& board);
// The poses that a chessboard is seen in if its points are numbered from another corner: B of the
// board as it is, B' of it numbered otherwise. The first is the identity.
std::vector<Pose> SameLookingTurns(const Board& board);

}  // namespace turnlight::calib::calibrate::board
