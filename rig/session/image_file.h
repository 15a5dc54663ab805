// Pictures in files: PNG and TIFF of 8 and 16 bits, TIFF and OpenEXR of 32-bit float; grey or
// colour.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

#include "base/result.h"

namespace turnlight::rig {

// Decodes a picture from a file's bytes; `file` names it in messages, its extension picks the
// format
// (.png, .tif, .tiff, .exr). Colour comes as R, G, B. The header's size is checked against expected
// (if not empty; otherwise at most 2^28 pixels) before anything is decoded or allocated.
// Read are: PNG, grey or RGB, 8 or 16 bits; TIFF, grey or RGB, 8 or 16 bits or float 32, in rows
// from the top left, uncompressed, LZW, deflate or PackBits; OpenEXR, one flat part with the
// channels Y or R, G, B, half or float, which come as float. Fails (kInput): unknown extension,
// damaged or truncated data, wrong size, anything else than the above, such as 2 or 4 channels.
Result<cv::Mat> DecodeImage(const std::string& bytes, const std::filesystem::path& file,
                            cv::Size expected = {});

// Reads and decodes.
Result<cv::Mat> ReadImage(const std::filesystem::path& path, cv::Size expected = {});

// The bytes of a picture's file; path's extension picks the format. image: CV_8U, CV_16U or CV_32F
// (.exr, .tif), grey or R, G, B. Deterministic: the same picture gives the same bytes.
Result<std::string> EncodeImage(const std::filesystem::path& path, const cv::Mat& image);

// Encodes and writes atomically.
Status WriteImage(const std::filesystem::path& path, const cv::Mat& image);

}  // namespace turnlight::rig
