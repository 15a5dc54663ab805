// The corners of a dark square on bright ground, from its sides.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "calib/calibrate/board/marker_layout.h"

namespace turnlight::calib::calibrate::board {

// Looks for each side within reach pixels of where it should be, along its middle, and crosses the
// lines that fit them: unlike a corner itself, which blur rounds off, a line stays where it is.
// Nothing where a side is not there. picture: CV_32F.
std::optional<Quad> RefineQuad(const cv::Mat& picture, const Quad& corners, double reach);

}  // namespace turnlight::calib::calibrate::board
