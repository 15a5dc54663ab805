// Pictures in files: PNG and TIFF of whole numbers, TIFF and OpenEXR of floats; grey or colour.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

#include "base/result.h"
#include "rig/session/picture_claims.h"

namespace turnlight::rig {

// image: CV_8U, CV_16U or CV_32F, grey or R, G, B.
struct Picture {
  cv::Mat image;
  PictureClaims claims;
};

// Decodes a picture from a file's bytes; `file` names it in messages, its extension picks the
// format (.png, .tif, .tiff, .exr). Colour comes as R, G, B. The header's size is checked against
// expected (if not empty; otherwise at most 2^28 pixels) before anything is decoded or allocated.
// Read are: PNG, grey or RGB, 8 or 16 bits; TIFF, as docs/design.md, section 7 lists; OpenEXR, one
// flat part with the channels Y or R, G, B, half or float, which come as float. Values are those of
// the file, never scaled. Fails (kInput): unknown extension, damaged or truncated data, wrong size,
// several pages, turned by a tag, anything else than the above, such as 2 or 4 channels.
Result<Picture> DecodePicture(const std::string& bytes, const std::filesystem::path& file,
                              cv::Size expected = {});
Result<cv::Mat> DecodeImage(const std::string& bytes, const std::filesystem::path& file,
                            cv::Size expected = {});

// Reads and decodes.
Result<cv::Mat> ReadImage(const std::filesystem::path& path, cv::Size expected = {});

// A mask in any form in which programs store one: what DecodePicture reads, and 1, 2 and 4 bits,
// palettes, alpha and a transparent colour. 255 where it is not black, else 0. Alpha decides alone
// where it varies and colour does not, colour alone where alpha does not vary; where both vary,
// what is black or transparent is 0. Fails (kInput) as DecodePicture does.
Result<cv::Mat1b> DecodeMask(const std::string& bytes, const std::filesystem::path& file,
                             cv::Size expected = {});
Result<cv::Mat1b> ReadMask(const std::filesystem::path& path, cv::Size expected = {});

// The bytes of a picture's file; path's extension picks the format. image: CV_8U, CV_16U or CV_32F
// (.exr, .tif), grey or R, G, B. Deterministic: the same picture gives the same bytes.
Result<std::string> EncodeImage(const std::filesystem::path& path, const cv::Mat& image);

// Encodes and writes atomically.
Status WriteImage(const std::filesystem::path& path, const cv::Mat& image);

}  // namespace turnlight::rig
