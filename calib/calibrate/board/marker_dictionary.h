// The dictionaries of square markers that OpenCV knows, by name.
#pragma once

#include <opencv2/aruco/dictionary.hpp>
#include <string>
#include <vector>

#include "base/result.h"

namespace turnlight::calib::calibrate::board {

// OpenCV's names without "DICT_": "4X4_50" to "7X7_1000", "ARUCO_ORIGINAL", "APRILTAG_16h5" to
// "APRILTAG_36h11".
const std::vector<std::string>& MarkerDictionaryNames();

// Letters of either case; "tag36h11", as AprilTag's own documents write it, is "APRILTAG_36h11".
// Fails (kInput) with the names that there are.
Result<cv::Ptr<cv::aruco::Dictionary>> FindMarkerDictionary(const std::string& name);

// The bits of a marker, CV_8U, 1 where it is bright, with its dark border one bit wide.
cv::Mat MarkerBits(const cv::aruco::Dictionary& dictionary, int id);

}  // namespace turnlight::calib::calibrate::board
