// All chessboards of a picture at one scale.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "calib/calibrate/board/corner_lattice.h"
#include "calib/calibrate/board/saddle_points.h"

namespace turnlight::calib::calibrate::board {

// Lattices of corners in a picture (CV_32F, 0 to 255), to about half a pixel. Each grows from nine
// corners that are seen as a plane is, by corners that are where a plane has them, so that boards
// which meet in a corner of a room are two. A saddle is in one lattice at most. Largest first; none
// of fewer than nine corners.
std::vector<CornerLattice> FindLattices(const cv::Mat& picture, const std::vector<Saddle>& saddles);

}  // namespace turnlight::calib::calibrate::board
