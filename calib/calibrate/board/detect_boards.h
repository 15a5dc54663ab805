// Where calibration boards are in a picture.
//
// Chessboards: corners of four squares are found at several scales and joined along their edges, so
// that several boards and parts of boards are seen (find_lattices.h). Where that gives no whole
// board, mrgingham and OpenCV's detectors are asked (whole_boards.h). Which corner is point 0 is
// NumberLattice's to say. A chessboard printed mirrored looks like itself: that can be told from
// markers alone. ChArUco boards and grids of tags: by their markers, refined likewise; any part of
// them will do.
//
// The same picture gives the same bits whatever the number of threads.
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/calibrate/board/board.h"

namespace turnlight::calib::calibrate::board {

struct DetectedBoard {
  BoardView view;
  double edge_sigma = 0.0;           // pixels; blur of its edges, about 0.5 in a sharp picture
  double saturated = 0.0;            // share of its bright pixels at the sensor's limit
  std::vector<std::string> remarks;  // what is odd about it, in words
};

struct Detection {
  std::vector<DetectedBoard> boards;  // most points first
  std::vector<std::string> remarks;   // why there is none, or what was left out, in words
  std::vector<GridSize> others;       // chessboards of another size than the one asked for
};

// picture: grey, CV_8U or CV_16U, as the sensor gives it; of colour, the caller's mean or green.
// Fails (kInput) on any other picture, and on a board that CheckBoard refuses. A picture without a
// board is no failure. A spread is above 1 where edges are blurred by more than 1.5 pixels.
Result<Detection> DetectBoards(const cv::Mat& picture, const Board& board);

// Of many pictures, in parallel; each is loaded by picture(i) when its turn comes, and done(i), if
// given, is called after it, from any thread. Neither may throw.
std::vector<Result<Detection>> DetectInPictures(
    std::size_t count, const std::function<Result<cv::Mat>(std::size_t)>& picture,
    const Board& board, const std::function<void(std::size_t)>& done = nullptr);

}  // namespace turnlight::calib::calibrate::board
