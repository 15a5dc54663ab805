// What a person wants to know of a picture's levels, channel by channel.
#pragma once

#include <array>
#include <cstddef>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calib/radiometry.h"

namespace turnlight::rig {

inline constexpr std::size_t kLevelBins = 40;

struct ChannelStatistics {
  std::string name;                                       // grey, R, G or B
  double min = 0.0, median = 0.0, mean = 0.0, max = 0.0;  // DN
  double clipped_share = 0.0;                             // at saturation or above, or not finite
  double black_share = 0.0;                               // at the black level or below
  // Pixels by level, in equal steps from black to white; what lies outside counts at the ends.
  std::array<std::size_t, kLevelBins> histogram{};
};

// image: CV_8U, CV_16U or CV_32F DN, 1 or 3 channels (R, G, B), not empty. bayer: RGGB, BGGR, GRBG
// or GBRG, of a mosaic of one channel; its sites of a colour are one channel here.
std::vector<ChannelStatistics> MeasureChannels(const cv::Mat& image,
                                               const calib::Radiometry& radiometry,
                                               const std::optional<std::string>& bayer = {});

}  // namespace turnlight::rig
