// Which saddles are neighbours on a chessboard, by the edges of the picture that join them.
#pragma once

#include <array>
#include <map>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "calib/calibrate/board/saddle_points.h"

namespace turnlight::calib::calibrate::board {

// A saddle in a grid whose directions are 0: +column, 1: +row, 2: -column, 3: -row. Its edge k
// leads in direction (k + turn) % 4.
struct Member {
  int saddle = 0;
  int turn = 0;
};

// By (column, row), which may be negative.
using SaddleGrid = std::map<std::pair<int, int>, Member>;

// Is the whole segment between two saddles an edge, one side darker than the other? picture:
// CV_32F.
bool IsEdge(const cv::Mat& picture, const Saddle& p, const Saddle& q);

// Saddles that hang together by edges, each in one grid at most; of at least four. In the order of
// their first saddles.
std::vector<SaddleGrid> LinkSaddles(const cv::Mat& picture, const std::vector<Saddle>& saddles);

}  // namespace turnlight::calib::calibrate::board
