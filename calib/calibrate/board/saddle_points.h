// Where the corners of four squares may be: saddle points of a picture's levels.
//
// A saddle is a maximum of Ixy^2 - Ixx Iyy (after a blur) whose surrounding circle changes four
// times between dark and bright, each change opposite to another one. From the four changes follow
// the directions of the two edges that cross there.
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace turnlight::calib::calibrate::board {

struct Saddle {
  Eigen::Vector2d pixel;  // of the picture given, to about half a pixel
  // Unit directions of the four edges that leave it, turning from x towards y. The sector from
  // edges[0] to edges[1] is dark, the next one bright, and so on.
  std::array<Eigen::Vector2d, 4> edges;
  double contrast = 0.0;  // level, bright less dark
};

// The value at a place within the picture, bilinear; CV_32F, one channel. Outside: the border's.
double LevelAt(const cv::Mat& picture, const Eigen::Vector2d& pixel);

// The saddle at a place, if the circle of that radius around it looks like one. picture: CV_32F,
// levels 0 to 255.
std::optional<Saddle> SaddleAt(const cv::Mat& picture, const Eigen::Vector2d& centre,
                               double radius);

// picture: CV_32F, one channel, levels 0 to 255. The strongest 3000, in the order of rows.
std::vector<Saddle> FindSaddles(const cv::Mat& picture);

}  // namespace turnlight::calib::calibrate::board
