// DetectBoards for boards with markers.
#pragma once

#include "calib/calibrate/board/detect_boards.h"

namespace turnlight::calib::calibrate::board {

// picture as DetectBoards takes it, levelled: Levelled(picture).
Detection DetectMarkerBoards(const cv::Mat& picture, const cv::Mat& levelled, const Board& board);

}  // namespace turnlight::calib::calibrate::board
