// The target's outline to a fraction of a pixel.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "calib/calibrate/placement/placement.h"

namespace turnlight::calib::calibrate::placement {

// Where the picture passes half way from the target's level to the background's, along normals of
// the mask's outline: levels 3 to 5 pixels inside and outside, the former brought to the edge by a
// line through the levels 3 to 7 pixels inside, as a body's shading is steep there. picture:
// linear, CV_32FC1 or CV_32FC3; empty: of the empty table, subtracted, or none. Sigma is what the
// noise makes of the slope and half of what that line changes, at least 0.05 pixels. Left out:
// points within 4 pixels of the border, with little contrast, or whose edge is not where the mask
// has it.
std::vector<OutlinePoint> FindOutline(const cv::Mat& picture, const cv::Mat& empty,
                                      const cv::Mat1b& mask);

// The outline of a mask alone, smoothed over a pixel or two.
std::vector<OutlinePoint> OutlineOfMask(const cv::Mat1b& mask);

}  // namespace turnlight::calib::calibrate::placement
