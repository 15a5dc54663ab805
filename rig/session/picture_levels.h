// Which digital numbers a picture uses: where its values end, and whether they are clipped there.
// Pure functions of pixels.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calib/radiometry.h"

namespace turnlight::rig {

// Of one channel, on the target.
struct ChannelLevels {
  // The largest value that at least kLeastOften pixels reach.
  double largest_often = 0.0;
  // The value at which pixels are clipped: the largest that occurs often, far oftener than those
  // next below it, and that others come near.
  std::optional<double> plateau;
};

struct PictureLevels {
  bool whole = false;           // whole numbers of 0 to 65535; nothing else is told of others
  int bits = 16;                // of the type that holds them: 8 or 16
  std::uint32_t used_bits = 0;  // that are 1 in any value of the picture
  double largest = 0.0;         // of the picture
  std::size_t distinct = 0;     // values on the target
  std::vector<ChannelLevels> channels;
};

inline constexpr std::size_t kLeastOften = 30;

// image: as decoded, before a mosaic is interpolated; CV_8U, CV_16U or CV_32F. mask: 255 = target.
PictureLevels MeasureLevels(const cv::Mat& image, const cv::Mat1b& mask);

// What is doubtful about radiometry beside the levels of a session's frames, with the value to set;
// empty if nothing is. A clipped value counts if two frames have it (or the only one).
std::string LevelsText(const calib::Radiometry& radiometry,
                       const std::vector<PictureLevels>& frames);

}  // namespace turnlight::rig
