#include "app/picture_report.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/format.h"
#include "rig/capture/frame_check.h"

namespace turnlight::app {
namespace {

// To two digits, as a person would write it.
double RoundToTwoDigits(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return std::round(value / unit) * unit;
}

}  // namespace

std::string HistogramBars(const std::array<std::size_t, rig::kLevelBins>& counts) {
  static const char* const kBars[] = {" ",      "\u2581", "\u2582", "\u2583", "\u2584",
                                      "\u2585", "\u2586", "\u2587", "\u2588"};
  const std::size_t most = *std::max_element(counts.begin(), counts.end());
  std::string text;
  for (const std::size_t count : counts) {
    const double height =
        count == 0 ? 0.0
                   : 1.0 + std::floor(7.0 * std::log(static_cast<double>(count)) /
                                          std::max(std::log(static_cast<double>(most)), 1e-9) +
                                      1e-9);
    text += kBars[static_cast<std::size_t>(std::clamp(height, 0.0, 8.0))];
  }
  return text;
}

std::string PictureKind(const cv::Mat& image, const std::optional<std::string>& bayer) {
  const std::string depth = image.depth() == CV_8U    ? "8 bits"
                            : image.depth() == CV_16U ? "16 bits"
                                                      : "32-bit floats";
  const std::string size = Format("%d x %d pixels, ", image.cols, image.rows) + depth;
  if (image.channels() == 3) return size + ", R, G, B";
  if (bayer) return size + ", the raw Bayer mosaic " + *bayer + " of one channel";
  return size + ", grey";
}

std::string LevelsText(const cv::Mat& image, const calib::Radiometry& radiometry,
                       const std::optional<std::string>& bayer) {
  const auto channels = rig::MeasureChannels(image, radiometry, bayer);
  std::string text =
      Format("levels in DN, black %.6g, white %.6g\n", radiometry.black, radiometry.white) +
      Format("  %-5s %8s %8s %8s %8s %9s %9s\n", "", "min", "median", "mean", "max", "clipped",
             "black");
  for (const rig::ChannelStatistics& channel : channels)
    text += Format("  %-5s %8.6g %8.6g %8.5g %8.6g %7.3g %% %7.3g %%\n", channel.name.c_str(),
                   channel.min, channel.median, channel.mean, channel.max,
                   100.0 * channel.clipped_share, 100.0 * channel.black_share);
  text += "histogram from black to white, the height by the logarithm of the pixels\n";
  for (const rig::ChannelStatistics& channel : channels)
    text += Format("  %-5s |", channel.name.c_str()) + HistogramBars(channel.histogram) + "|\n";
  return text;
}

std::string AdviceText(const cv::Mat& image, const calib::Radiometry& radiometry,
                       double exposure_us) {
  const auto check = rig::CheckFrame(image, radiometry, {}, {});
  std::string advice = rig::ExposureAdvice(check.statistics);
  if (advice.empty())
    advice = "the exposure uses the range and clips next to nothing";
  else
    advice += Format("; in the config: capture: {exposures_us: [%.10g]}",
                     RoundToTwoDigits(exposure_us * check.statistics.exposure_factor));
  return advice + "\n" +
         (check.verdict == rig::FrameVerdict::kGood
              ? "a capture would keep this picture\n"
              : "a capture would refuse this picture: " + check.text + "\n");
}

}  // namespace turnlight::app
