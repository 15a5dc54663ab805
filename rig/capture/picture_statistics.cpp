#include "rig/capture/picture_statistics.h"

#include <algorithm>
#include <cmath>

#include "base/statistics.h"

namespace turnlight::rig {
namespace {

// The name of the channel that a value belongs to.
char ColourOf(int row, int column, int channel, int channels,
              const std::optional<std::string>& bayer) {
  if (channels == 3) return "RGB"[channel];
  if (!bayer) return 'g';
  return (*bayer)[static_cast<std::size_t>(2 * (row % 2) + column % 2)];
}

ChannelStatistics Summarise(std::vector<float>& values, const calib::Radiometry& radiometry) {
  ChannelStatistics result;
  const auto count = static_cast<double>(values.size());
  std::erase_if(values, [](float value) { return !std::isfinite(value); });
  std::size_t clipped = 0, black = 0;
  double sum = 0.0;
  for (const float value : values) {
    sum += value;
    clipped += value >= radiometry.SaturationDn() ? 1 : 0;
    black += value <= radiometry.black ? 1 : 0;
    const double level = (value - radiometry.black) / (radiometry.white - radiometry.black);
    const double bin = std::clamp(std::floor(level * kLevelBins), 0.0, kLevelBins - 1.0);
    ++result.histogram[static_cast<std::size_t>(bin)];
  }
  result.clipped_share =
      (static_cast<double>(clipped) + count - static_cast<double>(values.size())) / count;
  result.black_share = static_cast<double>(black) / count;
  if (values.empty()) return result;
  result.mean = sum / static_cast<double>(values.size());
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  result.min = *least;
  result.max = *most;
  result.median = Median(values);
  return result;
}

}  // namespace

std::vector<ChannelStatistics> MeasureChannels(const cv::Mat& image,
                                               const calib::Radiometry& radiometry,
                                               const std::optional<std::string>& bayer) {
  cv::Mat1f dn;
  image.reshape(1).convertTo(dn, CV_32F);
  const int channels = image.channels();
  std::vector<ChannelStatistics> result;
  for (const char colour : std::string(channels == 1 && !bayer ? "g" : "RGB")) {
    std::vector<float> values;
    for (int row = 0; row < dn.rows; ++row)
      for (int i = 0; i < dn.cols; ++i)
        if (ColourOf(row, i / channels, i % channels, channels, bayer) == colour)
          values.push_back(dn(row, i));
    if (values.empty()) continue;
    result.push_back(Summarise(values, radiometry));
    result.back().name = colour == 'g' ? "grey" : std::string(1, colour);
  }
  return result;
}

}  // namespace turnlight::rig
