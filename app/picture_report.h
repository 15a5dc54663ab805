// A single picture for a person: its levels, a histogram, and what to do about the exposure.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "calib/radiometry.h"
#include "rig/capture/picture_statistics.h"
#include "rig/device.h"

namespace turnlight::app {

// Bars of eight heights, one a bin, by the logarithm of the counts; a bin with any pixel has one.
std::string HistogramBars(const std::array<std::size_t, rig::kLevelBins>& counts);

// "640 x 480 pixels, 16 bits, grey"; a mosaic is told as one.
std::string PictureKind(const cv::Mat& image, const std::optional<std::string>& bayer);

// Several lines, each ended: each channel's minimum, median, mean and maximum in DN, the shares
// that are clipped and black, histograms.
std::string LevelsText(const cv::Mat& image, const calib::Radiometry& radiometry,
                       const std::optional<std::string>& bayer);

// What the levels say to do, and what the gate of a capture would say; lines, each ended. With the
// line for the config, if the exposure should be another.
std::string AdviceText(const cv::Mat& image, const calib::Radiometry& radiometry,
                       double exposure_us);

}  // namespace turnlight::app
