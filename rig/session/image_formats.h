// The picture formats behind image_file.h, one file each. Internal to this folder.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

#include "base/result.h"
#include "rig/session/image_file.h"

namespace turnlight::rig {

// What a picture's header says, before anything is decoded.
struct ImageHeader {
  std::int64_t width = 0;
  std::int64_t height = 0;
  std::int64_t bits_per_pixel = 8;  // as stored, before compression
};

// What a picture is read for.
enum class PictureUse {
  kFrame,  // every value counts: grey or R, G, B, as stored
  kMask,   // any form in which programs store masks: few bits, palettes, alpha, which come as the
           // last channel of 2 or 4
};

// Refuses a size other than expected (if not empty), more than 2^28 pixels, and a picture that
// file_bytes cannot hold: no codec read here expands by more than 4096, so a small file with a huge
// header is truncated or hostile, and is refused before memory is taken for it.
Status CheckImageHeader(const ImageHeader& header, const std::string& file, cv::Size expected,
                        std::size_t file_bytes);

Result<Picture> DecodePng(const std::string& bytes, const std::string& file, cv::Size expected,
                          PictureUse use);
Result<Picture> DecodeTiff(const std::string& bytes, const std::string& file, cv::Size expected,
                           PictureUse use);
Result<Picture> DecodeExr(const std::string& bytes, const std::string& file, cv::Size expected,
                          PictureUse use);

// image: 1 or 3 channels (R, G, B) of a depth that the format has.
Result<std::string> EncodePng(const cv::Mat& image, const std::string& file);
Result<std::string> EncodeTiff(const cv::Mat& image, const std::string& file);
Result<std::string> EncodeExr(const cv::Mat& image, const std::string& file);

}  // namespace turnlight::rig
