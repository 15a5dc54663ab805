#include "calib/calibrate/response/blocks.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "base/statistics.h"

namespace turnlight::calib::calibrate::response {
namespace {

constexpr double kOutlyingSigmas = 6.0;
constexpr int kRejections = 3;
constexpr double kLowShare = 0.02;  // quantiles that stand for a block's darkest and brightest
constexpr int kLeastBlock = 8;      // pixels a side

cv::Rect BlockRect(const cv::Size& size, const cv::Size& grid, int place) {
  const int column = place % grid.width, row = place / grid.width;
  const int left = size.width * column / grid.width, right = size.width * (column + 1) / grid.width;
  const int top = size.height * row / grid.height, bottom = size.height * (row + 1) / grid.height;
  return {left, top, right - left, bottom - top};
}

std::vector<double> ValuesOf(const cv::Mat& plane, const cv::Rect& rect) {
  cv::Mat values;
  plane(rect).convertTo(values, CV_64F);
  return {values.begin<double>(), values.end<double>()};
}

// Noise of one picture from pairs, each difference without its mean and without the change of
// light. ratio: of the second picture's light to the first's, for each pair.
void MeasureNoise(const std::vector<std::vector<double>>& values, double black,
                  const std::vector<double>& ratios, Block& block) {
  double squares = 0.0, count = 0.0;
  for (std::size_t pair = 0; pair < ratios.size(); ++pair) {
    const auto &a = values[2 * pair], &b = values[2 * pair + 1];
    const double ratio = ratios[pair];
    std::vector<double> differences(a.size());
    for (std::size_t i = 0; i < a.size(); ++i)
      differences[i] = (b[i] - black) / ratio - (a[i] - black);
    const Moments of = RobustMoments(differences);
    squares += of.variance / (1.0 + 1.0 / (ratio * ratio)) * (of.count - 1.0);
    count += of.count - 1.0;
  }
  if (count <= 0.0) return;
  block.variance = squares / count;
  block.differences = count;
}

void MeasureBlock(const std::vector<std::vector<double>>& values, Block& block) {
  std::vector<double> all;
  for (const auto& picture : values) all.insert(all.end(), picture.begin(), picture.end());
  const Moments of = RobustMoments(all);
  block.mean = of.mean;
  block.spread = of.variance;
  block.middle = Median(all);
  block.low = LowerQuantile(all, kLowShare);
  block.high = LowerQuantile(all, 1.0 - kLowShare);
}

// How much more light the second picture of each pair has, over all planes.
std::vector<double> LightRatios(const std::vector<std::vector<Plane>>& pictures, double black) {
  std::vector<double> ratios;
  for (std::size_t first = 0; first + 1 < pictures.size(); first += 2) {
    double light[2] = {0.0, 0.0}, count = 0.0;
    for (std::size_t which = 0; which < 2; ++which)
      for (const Plane& plane : pictures[first + which]) {
        light[which] += cv::sum(plane.values)[0];
        count += which == 0 ? static_cast<double>(plane.values.total()) : 0.0;
      }
    const double a = light[0] - black * count, b = light[1] - black * count;
    // Of a dark frame nothing is left to compare.
    const bool lit = a > 2.0 * count && b > 0.5 * a && b < 2.0 * a;
    ratios.push_back(lit ? b / a : 1.0);
  }
  return ratios;
}

}  // namespace

// Sigma is that of the rest, again and again: a quantile would not do, of noise smaller than a step
// of the numbers it is 0.
Moments RobustMoments(const std::vector<double>& values) {
  Moments out;
  double low = -HUGE_VAL, high = HUGE_VAL;
  for (int round = 0; round <= kRejections; ++round) {
    double count = 0.0, sum = 0.0, squares = 0.0;
    for (const double v : values)
      if (v >= low && v <= high) {
        ++count;
        sum += v;
      }
    const double mean = sum / std::max(count, 1.0);
    for (const double v : values)
      if (v >= low && v <= high) squares += (v - mean) * (v - mean);
    out = {count, mean, squares / std::max(count - 1.0, 1.0)};
    const double reach = kOutlyingSigmas * std::sqrt(out.variance);
    low = mean - reach;
    high = mean + reach;
  }
  return out;
}

std::vector<Plane> PlanesOf(const cv::Mat& image, const std::optional<std::string>& bayer) {
  std::vector<Plane> planes;
  if (image.channels() == 3) {
    std::vector<cv::Mat> channels;
    cv::split(image, channels);
    for (int c = 0; c < 3; ++c)
      planes.push_back({channels[static_cast<std::size_t>(c)], c, {0, 0}, 1});
  } else if (!bayer) {
    planes.push_back({image, 1, {0, 0}, 1});
  } else {
    for (int i = 0; i < 4; ++i) {
      const int column = i % 2, row = i / 2;
      const char colour = (*bayer)[static_cast<std::size_t>(i)];
      cv::Mat values((image.rows - row + 1) / 2, (image.cols - column + 1) / 2, image.type());
      const std::size_t bytes = image.elemSize();
      for (int r = 0; r < values.rows; ++r)
        for (int c = 0; c < values.cols; ++c)
          std::copy_n(image.ptr(2 * r + row, 2 * c + column), bytes, values.ptr(r, c));
      planes.push_back({values, colour == 'R' ? 0 : colour == 'G' ? 1 : 2, {column, row}, 2});
    }
  }
  return planes;
}

std::string PlaneName(const std::vector<Plane>& planes, std::size_t plane) {
  if (planes.size() == 1) return "grey";
  static const char* const kNames[] = {"red", "green", "blue"};
  const int channel = planes[plane].channel;
  for (std::size_t i = 0; i < plane; ++i)
    if (planes[i].channel == channel) return std::string(kNames[channel]) + " (2nd)";
  return kNames[channel];
}

Group MeasureGroup(const std::vector<cv::Mat>& pictures, const std::optional<std::string>& bayer,
                   double exposure_us, double black, cv::Size grid) {
  Group out;
  out.exposure_us = exposure_us;
  out.pictures = pictures.size();
  std::vector<std::vector<Plane>> planes;
  for (const cv::Mat& picture : pictures) planes.push_back(PlanesOf(picture, bayer));
  const std::vector<double> ratios = LightRatios(planes, black);
  for (const double ratio : ratios) out.flicker = std::max(out.flicker, std::abs(ratio - 1.0));
  const cv::Size smallest = planes.front().back().values.size();
  grid.width = std::clamp(smallest.width / kLeastBlock, 1, grid.width);
  grid.height = std::clamp(smallest.height / kLeastBlock, 1, grid.height);
  const auto places = static_cast<std::size_t>(grid.area());
  out.blocks.resize(planes.front().size() * places);
  ParallelFor(out.blocks.size(), [&](std::size_t i) {
    Block& block = out.blocks[i];
    block.plane = i / places;
    block.place = i % places;
    const Plane& plane = planes.front()[block.plane];
    const cv::Rect rect = BlockRect(plane.values.size(), grid, static_cast<int>(block.place));
    block.x = plane.PixelX(rect.x + 0.5 * (rect.width - 1));
    block.y = plane.PixelY(rect.y + 0.5 * (rect.height - 1));
    block.pixels = rect.area();
    std::vector<std::vector<double>> values;
    for (const auto& picture : planes)
      values.push_back(ValuesOf(picture[block.plane].values, rect));
    MeasureBlock(values, block);
    MeasureNoise(values, black, ratios, block);
  });
  return out;
}

}  // namespace turnlight::calib::calibrate::response
