// Maps and plots of an estimate. Each is a whole page, R, G, B.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "estimator/estimate.h"

namespace turnlight::estimator::pictures {

// A signed residual (share of white; NaN where unobserved) from -range to range in blue, white,
// red, grey where unobserved, with a colour bar. Each value is drawn as enlarge^2 pixels.
cv::Mat3b ResidualPicture(const cv::Mat1f& residual, double range, int enlarge,
                          const std::string& title);

// A range for residual pictures that share it: 99.5 % of the values lie within, rounded up to 1, 2
// or 5 times a power of ten.
double ResidualRange(const std::vector<cv::Mat1f>& residuals);

// The map with axes in degrees and a colour bar, each light as a numbered ring at its direction
// from the reference point, with the 3-sigma circle about it where that is larger than a pixel, and
// a list of the lights below. Grey where nothing was seen.
cv::Mat3b IntensityPicture(const observe::IntensityMap& map,
                           const std::vector<LightEstimate>& lights);

// Residual rms by iteration, logarithmic upwards. Values that are not positive and finite are left
// out; there is at least one record.
cv::Mat3b ConvergencePicture(const std::vector<IterationRecord>& history);

}  // namespace turnlight::estimator::pictures
