// How far two pictures of the same view are apart, in units of the noise that they show themselves.
//
// Noise. The variance of second differences along rows, each channel by itself, is 6 times that of
// the noise, and the scene hardly shows in them: in those of the pictures' difference it cancels if
// both show the same, in those of one picture it does where it is smooth. The smaller of the two
// answers counts. It is told apart by level, as light has noise of its own.
// The noise of neighbouring pixels is taken to be independent; that is not so after demosaicing, so
// mosaics are compared as they are recorded.
#pragma once

#include <opencv2/core.hpp>

#include "calib/radiometry.h"

namespace turnlight::rig {

// Levels are shares of white above black: (DN - black) / (white - black). Values are those of all
// channels of the pixels that count: valid and finite in both pictures, and not saturated in both.
struct PictureDifference {
  std::size_t values = 0;     // 0: nothing could be compared, and all else is 0
  double rms = 0.0;           // of the differences' levels
  double rms_in_noise = 0.0;  // of the differences in units of their noise: about 1 for one view
  // Blocks of 16 x 16 pixels that are filled at least in half, all channels together. In each,
  // least squares of b - a = level + shift . gradient; noise averages out, and what became brighter
  // or moved does not. Where the gradients are lost in noise there is no shift.
  std::size_t blocks = 0;
  double level_rms = 0.0;  // of the blocks' mean differences
  // How many sigmas all levels together, and all shifts together, are above what chance gives:
  // normal with sigma 1 for one view, below -1 about as often as above 1.
  double level_sigmas = 0.0;
  double shift_sigmas = 0.0;
  double shift_rms_px = 0.0;  // of the blocks' shifts, in the recorded picture; noise has its part
  // The block that is furthest above what chance gives, level and shift together.
  double largest_sigmas = 0.0;
  double largest = 0.0;        // the size of its mean difference
  cv::Point largest_at{0, 0};  // its middle, a pixel
  // The second picture's brightness over the first's, less 1, by least squares; 0 with
  // brightness_sigma 0 if both are black.
  double brightness = 0.0;
  double brightness_sigma = 0.0;
};

// a, b: CV_8U, CV_16U or CV_32F DN of the same size, type and number of channels. valid: as many
// pixels, 0 where a pixel does not count. mosaic: a Bayer mosaic, one channel, its four colours
// being compared each with itself.
PictureDifference ComparePictures(const cv::Mat& a, const cv::Mat& b, const cv::Mat1b& valid,
                                  const calib::Radiometry& radiometry, bool mosaic);

}  // namespace turnlight::rig
