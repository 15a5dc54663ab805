// Pictures of calibration boards, whose points' true pixels are known.
//
// Each pixel is the mean of what a square of its size sees of the print, on a grid of sub-samples
// whose rays are the camera model's own, exact to 1e-4 pixels. Nothing of the world but the boards
// is there, and their light is even.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "calib/calibrate/board/board.h"
#include "calib/camera_model.h"
#include "calib/pose.h"

namespace turnlight::rig::sim {

// A board that calib/calibrate/board's CheckBoard accepts. From behind, it is bright all over.
struct PlacedBoard {
  calib::calibrate::board::Board board;
  calib::Pose X_CB;
  double quiet_border = 0.0;  // length unit; bright paper around the print
};

// Levels are fractions of the format's white, 0..1.
struct BoardPictureOptions {
  double bright = 0.8;
  double dark = 0.05;
  double background = 0.4;
  int samples = 4;           // across and down a pixel, 1..32
  double blur_sigma = 0.0;   // pixels, at least 0; Gaussian
  double noise_sigma = 0.0;  // level, at least 0; normal, independent of the level
  int depth = CV_8U;         // or CV_16U
  std::uint64_t seed = 0;    // of the noise,
  std::uint64_t stream = 0;  // and which picture it is
};

// The picture, one channel. A board hides those before it in the list.
cv::Mat RenderBoards(const std::vector<PlacedBoard>& boards, const calib::CameraModel& camera,
                     const BoardPictureOptions& options = {});

// The pixels of all points, by number; (0, 0) is the centre of the top-left pixel. NaN where the
// lens does not reach; outside of the picture as they come.
std::vector<Eigen::Vector2d> BoardPixels(const PlacedBoard& placed,
                                         const calib::CameraModel& camera);

}  // namespace turnlight::rig::sim
