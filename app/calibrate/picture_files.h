// Pictures that somebody took with any camera, as files.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "base/result.h"

namespace turnlight::app {

// The files that arguments name: a file is itself, a folder its .png, .tif, .tiff, .jpg and .jpeg,
// in the order of their names ("image2" before "image10"). Fails (kInput): one is not there, a
// folder without pictures, a file named twice, nothing named at all.
Result<std::vector<std::filesystem::path>> ListPictures(const std::vector<std::string>& arguments);

// By its name's ending.
bool IsJpeg(const std::filesystem::path& path);

// What rig::ReadImage reads, or a JPEG as it is stored; neither is turned. Fails (kInput).
Result<cv::Mat> ReadPicture(const std::filesystem::path& path);

struct GreyPicture {
  cv::Mat grey;                      // CV_8U or CV_16U, as on the sensor: never turned
  std::vector<std::string> remarks;  // in words, without the file's name
};

// PNG, TIFF of 8 or 16 bits, JPEG; colour becomes its brightness. A photograph that asks to be
// turned (EXIF) is kept as the sensor has it, with a remark. Fails (kInput) with the file's name.
Result<GreyPicture> ReadGreyPicture(const std::filesystem::path& path);

// The size that most pictures have (of as many, the first), and which have another. Empty sizes, of
// files that could not be read, count for nothing.
struct CommonSize {
  cv::Size size;
  std::vector<std::size_t> others;
};
CommonSize FindCommonSize(const std::vector<cv::Size>& sizes);

}  // namespace turnlight::app
