// What a calibration is judged by with the eye.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "calib/calibrate/lens/assess_lens.h"
#include "calib/calibrate/lens/calibrate_lens.h"

namespace turnlight::calib::calibrate::lens {

struct ReportPicture {
  std::string name;  // of its file, such as "residuals.png"
  cv::Mat3b page;    // R, G, B
};

// residuals.png: residuals as arrows over the sensor. views.png: rms of each view. histogram.png:
// residuals against the normal distribution. coverage.png: points in each cell of the sensor.
// uncertainty.png: of a projection, at infinity; uncertainty_at_distance.png if a distance was
// given. halves.png: the difference of the two halves of the pictures, where there is one.
std::vector<ReportPicture> ReportPictures(const std::vector<PictureViews>& pictures,
                                          const LensCalibration& calibration,
                                          const LensAssessment& assessment,
                                          const std::string& length_unit);

}  // namespace turnlight::calib::calibrate::lens
