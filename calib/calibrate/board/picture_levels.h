// The levels of a picture, made ready for detection, and what is odd about them.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "base/result.h"

namespace turnlight::calib::calibrate::board {

// Fails (kInput) unless it is grey, 8 or 16 bits, of at least 32 x 32 pixels.
Status CheckPicture(const cv::Mat& picture);

// CV_32F, 0 to 255: from the level that a thousandth of the pixels are below to that which as many
// are above. picture: as CheckPicture accepts it.
cv::Mat Levelled(const cv::Mat& picture);

// The level at which the sensor ends, if pixels reach it: the picture's highest, where it is the
// highest of 8, 10, 12, 14 or 16 bits (or the like: within 1 %). Otherwise above all levels.
double SaturationLevel(const cv::Mat& picture);

// Why a picture may show nothing: all dark, all bright, without contrast.
std::vector<std::string> RemarksOnLevels(const cv::Mat& picture);

}  // namespace turnlight::calib::calibrate::board
