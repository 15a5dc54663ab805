// Where the markers of a board are, and which of the markers in a picture are where such a board
// has them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <vector>

#include "calib/calibrate/board/board.h"

namespace turnlight::calib::calibrate::board {

using Quad = std::array<Eigen::Vector2d, 4>;  // corners, clockwise from a marker's top left

struct SeenMarker {
  int id = 0;
  Quad corners;  // pixels
};

// How a board is printed beyond what it is said to be: printers differ.
struct MarkerLayout {
  bool begins_dark = true;  // the first square of a ChArUco board; bright in OpenCV before 4.7
                            // where the squares are even in number from top to bottom
  bool from_below = false;  // tags are numbered from the bottom row upwards, as Kalibr's are
  int turn = 0;             // quarters by which all tags are turned in the grid
};

// The layouts that boards of this kind come in, the usual one first.
std::vector<MarkerLayout> MarkerLayouts(const Board& board);

// x, y in B of the corners of every marker, by its number.
std::map<int, Quad> MarkerPlaces(const Board& board, const MarkerLayout& layout);

// The largest set of markers (indices into seen) that are where the layout has them; each number
// once. Empty if fewer than two are.
std::vector<std::size_t> FittingMarkers(const std::vector<SeenMarker>& seen,
                                        const std::map<int, Quad>& places);

}  // namespace turnlight::calib::calibrate::board
