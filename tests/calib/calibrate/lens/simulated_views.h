// A camera that sees a board at random poses, with noise: what a calibration is tried on.
#pragma once

#include <cstdint>
#include <vector>

#include "calib/calibrate/board/board.h"
#include "calib/calibrate/lens/calibrate_lens.h"
#include "calib/camera_model.h"

namespace turnlight::calib::calibrate::lens {

struct SimulatedViews {
  int pictures = 20;
  double noise_px = 0.3;     // standard deviation per axis
  double tilt_deg = 35.0;    // largest, about the board's x and y
  double width_share = 0.5;  // of the picture's width that the board takes, about
  Eigen::Vector2d warp{0.0, 0.0};
  std::uint64_t pose_seed = 1, noise_seed = 1;
};

// 2000 x 1400 pixels, barrel distortion, OPENCV8.
CameraModel ExampleLens();
board::Board ExampleBoard(int columns = 10, int rows = 10);

// Named p00, p01, ... Points outside the picture are left out.
std::vector<PictureViews> SimulateViews(const CameraModel& camera, const board::Board& board,
                                        const SimulatedViews& how);

}  // namespace turnlight::calib::calibrate::lens
