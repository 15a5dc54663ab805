// Boards in pictures that somebody took, for the calibration of a lens.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "calib/calibrate/board/board.h"
#include "calib/calibrate/lens/calibrate_lens.h"

namespace turnlight::app {

struct BoardPictures {
  std::vector<calib::calibrate::lens::PictureViews> views;  // as the files are listed
  std::vector<std::string> remarks;  // with the picture's name: blurred, overexposed, ...
};

// arguments: files, folders, or raw captures (their frames of kind "board", or all if there are
// none). Shows its progress. A picture that cannot be read shows nothing, and says why. Fails
// (kInput): files that are not there, none at all, or that show another board.
Result<BoardPictures> FindBoardsInPictures(const std::vector<std::string>& arguments,
                                           const calib::calibrate::board::Board& board);

}  // namespace turnlight::app
