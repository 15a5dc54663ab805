// Detectors of whole chessboards, one in a picture: second opinions.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "calib/calibrate/board/corner_lattice.h"

namespace turnlight::calib::calibrate::board {

// The first that finds all corners of: mrgingham (as many across as down), OpenCV's detector by
// sectors, OpenCV's classical one. picture: CV_8U. The corners are to about a pixel.
std::optional<CornerLattice> FindWholeBoard(const cv::Mat& picture, int columns, int rows);

}  // namespace turnlight::calib::calibrate::board
