// A calibrated axis for people: words and pictures.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "calib/calibrate/axis/calibrate_axis.h"

namespace turnlight::calib::calibrate::axis {

// Lines, each ended: the axis with its sigmas, scale, backlash, closure, what was left out and why,
// and a verdict.
std::string AxisText(const AxisCalibration& axis, const std::vector<AxisView>& views,
                     const std::string& length_unit);
// One sentence.
std::string AxisVerdict(const AxisCalibration& axis, const std::string& length_unit);

// How far each view's board stands from where its angle puts it, and how well its corners fit.
cv::Mat3b DrawAxisViews(const AxisCalibration& axis, const std::vector<AxisView>& views);
// Camera, axis and board to scale, from above and from the side.
cv::Mat3b DrawAxisPlan(const AxisCalibration& axis, const board::Board& board,
                       const std::string& length_unit);

}  // namespace turnlight::calib::calibrate::axis
