// How well a board is seen.
#pragma once

#include <algorithm>
#include <opencv2/core.hpp>

#include "calib/calibrate/board/corner_lattice.h"

namespace turnlight::calib::calibrate::board {

// Of the edges between neighbouring corners, in pixels: the standard deviation of a Gaussian that
// would blur an ideal edge as much, the median of all. A sharp picture has about 0.5. picture: CV_32F.
double EdgeSigma(const cv::Mat& picture, const CornerLattice& lattice);

// How much less a point is known than a sharply seen one: its spread (board.h). Noise moves a blurred
// edge in proportion to its width.
inline double SpreadOf(double edge_sigma) { return std::max(1.0, edge_sigma / 1.5); }

// The share of the bright squares between the corners whose middle reaches a level. picture: CV_8U or
// CV_16U.
double SaturatedShare(const cv::Mat& picture, const CornerLattice& lattice, double level);

}  // namespace turnlight::calib::calibrate::board
