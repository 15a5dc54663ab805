// What the numbers of a picture say about whether it may be kept: the gate behind every exposure,
// and the comparison of two pictures of the same angle.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "calib/radiometry.h"

namespace turnlight::rig {

// Levels are shares of white above black: (DN - black) / (white - black).
struct FrameStatistics {
  double mean_level = 0.0;       // over all pixels and channels
  double bright_level = 0.0;     // that 1 % of the pixels exceed (brightest channel)
  double saturated_share = 0.0;  // of pixels with a channel at saturation or above, or not finite
  // What to multiply the exposure by so that about a thousandth of the pixels exceeds four fifths
  // of saturation: 1/16..100. How bright clipped pixels really are is not known; it is estimated
  // from the ones below them, and following it twice or thrice gets there.
  double exposure_factor = 1.0;
};
// image: CV_8U, CV_16U or CV_32F DN, 1 or 3 channels, not empty.
FrameStatistics MeasureFrame(const cv::Mat& image, const calib::Radiometry& radiometry);

// What to do about the exposure, measured first: "2.1 % clipped: halve the exposure". Empty if it
// is good: hardly anything is clipped, and the brightest pixels use the range.
std::string ExposureAdvice(const FrameStatistics& statistics);

struct FrameGate {
  double min_bright_level = 0.005;    // below: all black
  double max_saturated_share = 0.25;  // above: over-exposed
  // Mean level against the median of the frames before, both ways: lamp off, lamp changed. Only
  // applied once there are min_history of them.
  double min_level_ratio = 0.5;
  double max_level_ratio = 2.0;
  std::size_t min_history = 3;
};

enum class FrameVerdict { kGood, kAllBlack, kSaturated, kLampOff, kLampBright };

struct FrameCheck {
  FrameVerdict verdict = FrameVerdict::kGood;
  std::string text;  // measured against allowed, and what to do; empty if good
  FrameStatistics statistics;
};
// previous: mean_level of the good frames of the same exposure before this one, in any order.
FrameCheck CheckFrame(const cv::Mat& image, const calib::Radiometry& radiometry,
                      const FrameGate& gate, const std::vector<double>& previous);

// How far apart two pictures of the same view are; the closure check compares start and end.
struct FrameDifference {
  double rms = 0.0;  // of levels, over the lit pixels: a level above 0.01 in one, none saturated
  double noise_rms = 0.0;  // what the pictures' own noise explains of it
  std::size_t pixels = 0;
  double Sigmas() const { return noise_rms > 0.0 ? rms / noise_rms : 0.0; }
  // The same of means over blocks of 8 x 8 pixels and all channels, in which noise averages out
  // and what has moved does not: the differences' rms in units of what noise explains, about 1 for
  // two pictures of the same view; and their rms as a share of the blocks' rms level. Blocks that
  // are lit in half of their pixels count; without any (`blocks` is 0) nothing was compared.
  int blocks = 0;
  double block_sigmas = 0.0;
  double block_share = 0.0;
};
// Same size and type, not empty. The noise is measured in the pictures: from second differences
// along rows of their difference, in which the scene cancels; at least that of rounding to whole
// DN.
FrameDifference CompareFrames(const cv::Mat& first, const cv::Mat& second,
                              const calib::Radiometry& radiometry);

}  // namespace turnlight::rig
