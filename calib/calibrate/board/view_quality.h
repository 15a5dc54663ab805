// How well a board is seen.
#pragma once

#include <algorithm>
#include <opencv2/core.hpp>
#include <vector>

#include "calib/calibrate/board/board.h"
#include "calib/calibrate/board/corner_lattice.h"

namespace turnlight::calib::calibrate::board {

// A straight edge of the print, from p to q, and how far the levels on both sides of it are even.
struct PrintEdge {
  Eigen::Vector2d p, q;
  double reach = 0.0;  // pixels
};

// The edges between neighbouring corners, even over a share of the squares' width.
std::vector<PrintEdge> EdgesOf(const CornerLattice& lattice, double share);

// In pixels: the standard deviation of a Gaussian that would blur an ideal edge as much, the median
// of all. A sharp picture has about 0.5. picture: CV_32F.
double EdgeSigma(const cv::Mat& picture, const std::vector<PrintEdge>& edges);

// How much less a point is known than a sharply seen one: its spread (board.h). Noise moves a
// blurred edge in proportion to its width.
inline double SpreadOf(double edge_sigma) { return std::max(1.0, edge_sigma / 1.5); }

// Of the bright pixels among a view's points, the share that reaches the sensor's limit. levelled:
// Levelled(picture).
double SaturatedShare(const cv::Mat& picture, const cv::Mat& levelled, const BoardView& view);

}  // namespace turnlight::calib::calibrate::board
