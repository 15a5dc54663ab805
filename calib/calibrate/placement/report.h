// A placement for people: words and pages.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "calib/calibrate/placement/placement.h"

namespace turnlight::calib::calibrate::placement {

// Lines, each ended: where the target is, how well that is known and from what, how the outlines
// fit, what whole pictures say of wobble.
std::string Verdict(const Placement& placement, const std::vector<View>& views,
                    const std::string& unit);

// Photographs of at most six angles, cut out around the target, with the outline that the placement
// asks for and the points that were left out. pictures: one per view, linear, CV_32FC1 or CV_32FC3;
// those that are empty are not shown.
cv::Mat3b OverlayPage(const std::vector<cv::Mat>& pictures, const rig::RigCalibration& calibration,
                      const calib::TargetShape& shape, const std::vector<View>& views,
                      const Placement& placement);

// Residuals of all views, by where they are around the outline.
cv::Mat3b ResidualPage(const std::vector<View>& views, const Placement& placement);

}  // namespace turnlight::calib::calibrate::placement
