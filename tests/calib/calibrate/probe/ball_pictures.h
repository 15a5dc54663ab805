// A simulated mirror ball that cameras look at from all around, and what is found in the pictures.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "calib/calibrate/probe/ball.h"
#include "calib/calibrate/probe/spots.h"
#include "calib/radiometry.h"
#include "rig/sim/mirror_ball.h"

namespace turnlight::calib::calibrate::probe {

struct BallPictures {
  int width = 320, height = 320;
  double focal = 1900.0;  // pixels
  rig::sim::MirrorBall ball;
  rig::sim::MirrorRoom room;
  double camera_distance = 420.0, elevation_deg = 25.0;
  int views = 1;
  double arc_deg = 360.0;
  double blur_px = 0.6;
  double noise = 0.0;  // sigma, share of white
  double white = 1e9;  // radiance that clips
  std::uint64_t seed = 1;
};

// A camera, its rays and the views of the true ball.
struct BallStudio {
  explicit BallStudio(const BallPictures& pictures);
  CameraModel camera;
  RayGrid rays;
  std::vector<BallView> views;
};

LinearImage TakePicture(const BallPictures& pictures, const BallStudio& studio, std::size_t view);

// Noise-free pictures, which may be given noise again and again.
std::vector<cv::Mat1f> RenderAll(const BallPictures& pictures, const BallStudio& studio);
LinearImage WithNoise(const BallPictures& pictures, const cv::Mat1f& radiance, std::size_t view);

}  // namespace turnlight::calib::calibrate::probe
