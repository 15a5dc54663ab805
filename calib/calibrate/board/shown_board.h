// Do pictures show the board that somebody says they show?
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "calib/calibrate/board/board.h"
#include "calib/calibrate/board/detect_boards.h"

namespace turnlight::calib::calibrate::board {

// A part of one chessboard may pass for a part of another, so that only all pictures together tell.
// Fails (kInput) with the size that they show: where most show a whole chessboard of another
// size and hardly any the board, or where the same part of it, and no more, is all that most
// show. names: of the pictures, for people. Boards with markers pass.
Status CheckShownBoard(const std::vector<std::string>& names,
                       const std::vector<Result<Detection>>& found, const Board& board);

}  // namespace turnlight::calib::calibrate::board
