// A board as a person writes it, on a command line or in a config.
#pragma once

#include <optional>
#include <string>

#include "base/result.h"
#include "base/strict_object.h"
#include "calib/calibrate/board/board.h"

namespace turnlight::calib::calibrate::board {

struct BoardWords {
  std::string size;  // "COLSxROWS": inner corners, or tags of a grid
  // mm; between neighbouring corners, or from the left edge of a tag to that of the next one
  std::optional<double> square_mm;
  std::optional<double> marker_mm;  // side of a marker or tag; only with a dictionary
  std::string charuco;              // dictionary of a ChArUco board's markers; empty if it is none
  std::string apriltag;             // dictionary of a grid of tags, likewise
};

// Lengths in mm. Fails (kInput) with the option's name, the value and what is allowed.
Result<Board> ParseBoard(const BoardWords& words);

// As an object of a config: kind (chessboard, charuco, apriltags; chessboard if left out), columns,
// rows, spacing, and of those with markers marker and dictionary, as the members of Board.
Result<Board> ReadBoard(StrictObject object);

// "a chessboard of 10 x 7 inner corners 18 mm apart"
std::string BoardText(const Board& board);

}  // namespace turnlight::calib::calibrate::board
