// Pictures in files: PNG and TIFF of 8 and 16 bits, TIFF and OpenEXR of 32-bit float; grey or
// colour.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

#include "base/result.h"

namespace turnlight::rig {

// Decodes a picture from a file's bytes; `file` names it in messages, its extension picks the
// format
// (.png, .tif, .tiff, .exr). Colour comes as R, G, B. The header's size is checked against expected
// (if not empty) before anything is decoded or allocated. Fails (kInput): unknown extension,
// damaged or truncated data, wrong size, 2 or 4 channels, a depth other than 8, 16 or float 32
// (half too, in OpenEXR).
Result<cv::Mat> DecodeImage(const std::string& bytes, const std::filesystem::path& file,
                            cv::Size expected = {});

// Reads and decodes.
Result<cv::Mat> ReadImage(const std::filesystem::path& path, cv::Size expected = {});

// Encodes by extension and writes atomically. image: CV_8U, CV_16U or CV_32F (.exr, .tif), grey or
// R, G, B. Deterministic: the same picture gives the same bytes.
Status WriteImage(const std::filesystem::path& path, const cv::Mat& image);

}  // namespace turnlight::rig
