// What one picture tells of the target's place: segmented, its outline found.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calib/calibrate/placement/placement.h"

namespace turnlight::calib::calibrate::placement {

// Linear radiance, CV_32FC1 or CV_32FC3; what is not given is empty. Of one size and type.
struct Pictures {
  cv::Mat lit;       // the target under the lamps
  cv::Mat empty;     // the table without it
  cv::Mat lamp_off;  // the ambient light alone: subtracted from both
  cv::Mat1b mask;    // 255 = target; then the target is not looked for
};

struct PictureView {
  View view;
  cv::Mat1b mask;                    // 255 = target; empty if there is none
  bool from_mask = false;            // the picture shows no clear edge where the given mask has it
  std::vector<std::string> remarks;  // begin with the view's label
};

// Of an edge offset, in pixels, where only masks give the outline: whether a pixel on it counts as
// target is a convention.
inline constexpr double kMaskOffsetSigma = 0.5;

// Fails (kInput) if sizes or types differ. A picture without a target gives a view without an
// outline and a remark.
Result<PictureView> ViewOfPicture(const Pictures& pictures, double angle_deg,
                                  const std::string& label);

}  // namespace turnlight::calib::calibrate::placement
