// Boards that look the same from several sides, and are not flat: which side is which.
//
// Nothing in one picture tells the point 0 of a board of 7 x 7 corners from that opposite. To a
// flat board it does not matter. Where the board is not flat its shape turns with the numbering,
// and only if all views agree can the place of each point be fitted (board_shape.h).
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calib/calibrate/board/board.h"
#include "calib/calibrate/lens/problem.h"

namespace turnlight::calib::calibrate::lens {

// For each of the problem's views, which of SameLookingNumberings(board) to take, so that one shape
// explains their residuals best, to first order. Nothing if no view need change or no shape
// explains much.
std::optional<std::vector<std::size_t>> AgreeingNumberings(const board::Board& board,
                                                           const Problem& problem,
                                                           const Pass& pass);

}  // namespace turnlight::calib::calibrate::lens
