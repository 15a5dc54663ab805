// Place and size of one spot. Internal to spots.
#pragma once

#include <opencv2/core.hpp>

#include "calib/calibrate/probe/peaks.h"
#include "calib/calibrate/probe/spots.h"

namespace turnlight::calib::calibrate::probe {

// What is known around a ball's spots; all maps are of one box of the picture.
struct SpotMaps {
  const cv::Mat1f& grey;     // radiance
  const cv::Mat1f& ground;   // its broad part
  const cv::Mat1f& rest;     // the smoothed radiance less the ground: what peaks are of
  const cv::Mat1b& clipped;  // non-zero: at or above saturation
  const cv::Mat1b& usable;
  cv::Point origin;  // of the box in the picture
  double noise = 0.0;
};

struct SpotShape {
  bool measured = false;
  bool cut = false;  // it goes on where the ball cannot be looked at
  Spot spot;         // without kind and why
};

SpotShape MeasureShape(const SpotMaps& maps, const Peak& peak, const BallView& view);

}  // namespace turnlight::calib::calibrate::probe
