// What a response is judged by with the eye.
#pragma once

#include <opencv2/core.hpp>

#include "calib/calibrate/response/response.h"

namespace turnlight::calib::calibrate::response {

// The noise's variance over the light, both logarithmic, with the fitted line.
cv::Mat3b DrawPhotonTransfer(const PhotonTransfer& transfer,
                             const std::vector<std::string>& planes);
// Each block's deviation from proportional light, as taken and as if it were linear.
cv::Mat3b DrawLinearity(const ResponseCurve& curve);
// The share of the centre's light as measured, and what the fit leaves.
cv::Mat3b DrawFlatField(const FlatField& flat, const cv::Size& size);

}  // namespace turnlight::calib::calibrate::response
