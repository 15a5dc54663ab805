#include "calib/calibrate/board/picture_levels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/format.h"

namespace turnlight::calib::calibrate::board {
namespace {

constexpr int kLeastSide = 32;        // pixels; no board is seen in fewer
constexpr double kTail = 0.001;       // of the pixels, beyond each end of the levels
constexpr double kNearlyFull = 0.99;  // of a format's white: some sensors end just below

std::vector<std::size_t> Histogram(const cv::Mat& picture) {
  std::vector<std::size_t> counts(picture.depth() == CV_8U ? 256 : 65536, 0);
  for (int row = 0; row < picture.rows; ++row)
    for (int column = 0; column < picture.cols; ++column)
      ++counts[picture.depth() == CV_8U ? picture.at<std::uint8_t>(row, column)
                                        : picture.at<std::uint16_t>(row, column)];
  return counts;
}

// The lowest level that more than a share of the pixels do not exceed.
double Quantile(const std::vector<std::size_t>& counts, double share) {
  std::size_t all = 0;
  for (const std::size_t count : counts) all += count;
  std::size_t below = 0;
  for (std::size_t level = 0; level < counts.size(); ++level) {
    below += counts[level];
    if (static_cast<double>(below) > share * static_cast<double>(all))
      return static_cast<double>(level);
  }
  return static_cast<double>(counts.size() - 1);
}

}  // namespace

Status CheckPicture(const cv::Mat& picture) {
  if (picture.empty()) return InputError("the picture is empty");
  if (picture.type() != CV_8UC1 && picture.type() != CV_16UC1)
    return InputError("a picture of boards must be grey with 8 or 16 bits, not " +
                      cv::typeToString(picture.type()));
  if (picture.cols < kLeastSide || picture.rows < kLeastSide)
    return InputError(Format("a picture of %d x %d pixels is too small for a board (at least %d)",
                             picture.cols, picture.rows, kLeastSide));
  return {};
}

cv::Mat Levelled(const cv::Mat& picture) {
  const auto counts = Histogram(picture);
  const double low = Quantile(counts, kTail);
  const double high = std::max(Quantile(counts, 1.0 - kTail), low + 1.0);
  cv::Mat levelled;
  const double scale = 255.0 / (high - low);
  picture.convertTo(levelled, CV_32F, scale, -low * scale);
  cv::min(levelled, 255.0, levelled);
  cv::max(levelled, 0.0, levelled);
  return levelled;
}

double SaturationLevel(const cv::Mat& picture) {
  double highest = 0.0;
  cv::minMaxLoc(picture, nullptr, &highest);
  for (const int bits : {8, 10, 12, 14, 16}) {
    if (picture.depth() == CV_8U && bits > 8) continue;
    const double white = std::ldexp(1.0, bits) - 1.0;
    if (highest <= white && highest >= kNearlyFull * white) return highest;
  }
  return std::numeric_limits<double>::infinity();
}

std::vector<std::string> RemarksOnLevels(const cv::Mat& picture) {
  const auto counts = Histogram(picture);
  const double low = Quantile(counts, 0.02);
  const double high = Quantile(counts, 0.98);
  const double white = static_cast<double>(counts.size() - 1);
  constexpr double kFewLevels = 0.04;  // of white: what a dark or flat picture has
  if (Quantile(counts, 0.5) >= SaturationLevel(picture))
    return {"overexposed: more than half of the picture is at the sensor's limit"};
  if (high - low < kFewLevels * white && high < kFewLevels * white && white < 256.0)
    return {"underexposed: 98 % of the picture is below " + NumberText(high + 1.0) + " of " +
            NumberText(white)};
  if (high - low < std::max(2.0, kFewLevels * high))
    return {"without contrast: 96 % of the picture lies between the levels " + NumberText(low) +
            " and " + NumberText(high)};
  return {};
}

}  // namespace turnlight::calib::calibrate::board
