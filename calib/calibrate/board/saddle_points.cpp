#include "calib/calibrate/board/saddle_points.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace turnlight::calib::calibrate::board {
namespace {

constexpr double kBlur = 1.5;               // pixels, before the second derivatives
constexpr double kRing = 4.5;               // pixels; squares narrower than this are not seen
constexpr int kRingSamples = 32;            // 0.9 pixels apart
constexpr std::size_t kMostSaddles = 3000;  // bounds the pairs that are looked at later
constexpr double kLeastContrast = 10.0;     // of 255 levels
// Of sqrt(Ixy^2 - Ixx Iyy): a corner of contrast c seen with blur s has c / (pi s^2).
constexpr double kLeastResponse = 0.7;
constexpr double kMostBend = 0.35;  // radians between an edge and the one that continues it

cv::Mat SaddleResponse(const cv::Mat& picture) {
  cv::Mat blurred, xx, yy, xy;
  cv::GaussianBlur(picture, blurred, cv::Size(), kBlur, kBlur, cv::BORDER_REPLICATE);
  const cv::Mat second = (cv::Mat_<float>(1, 3) << 1, -2, 1);
  const cv::Mat mixed = (cv::Mat_<float>(3, 3) << 0.25, 0, -0.25, 0, 0, 0, -0.25, 0, 0.25);
  cv::filter2D(blurred, xx, CV_32F, second, {-1, -1}, 0, cv::BORDER_REPLICATE);
  cv::filter2D(blurred, yy, CV_32F, second.t(), {-1, -1}, 0, cv::BORDER_REPLICATE);
  cv::filter2D(blurred, xy, CV_32F, mixed, {-1, -1}, 0, cv::BORDER_REPLICATE);
  return xy.mul(xy) - xx.mul(yy);
}

struct Peak {
  float response;
  int column, row;
};

std::vector<Peak> Peaks(const cv::Mat& response) {
  cv::Mat highest;
  cv::dilate(response, highest, cv::Mat::ones(5, 5, CV_8U));
  std::vector<Peak> peaks;
  const int margin = static_cast<int>(std::ceil(kRing));
  for (int row = margin; row < response.rows - margin; ++row) {
    const auto* values = response.ptr<float>(row);
    const auto* tops = highest.ptr<float>(row);
    for (int column = margin; column < response.cols - margin; ++column)
      if (values[column] >= tops[column] && values[column] > kLeastResponse * kLeastResponse)
        peaks.push_back({values[column], column, row});
  }
  return peaks;
}

double Angle(int sample) { return 2.0 * std::numbers::pi * sample / kRingSamples; }

// Levels on the circle, the mean of three neighbours each.
std::array<double, kRingSamples> Ring(const cv::Mat& picture, const Eigen::Vector2d& centre,
                                      double radius) {
  std::array<double, kRingSamples> raw;
  for (int i = 0; i < kRingSamples; ++i)
    raw[static_cast<std::size_t>(i)] =
        LevelAt(picture, centre + radius * Eigen::Vector2d(std::cos(Angle(i)), std::sin(Angle(i))));
  std::array<double, kRingSamples> ring;
  for (std::size_t i = 0; i < ring.size(); ++i)
    ring[i] = (raw[(i + raw.size() - 1) % raw.size()] + raw[i] + raw[(i + 1) % raw.size()]) / 3.0;
  return ring;
}

// The angles where the circle crosses `middle`, in order, the first one towards dark.
std::vector<double> Crossings(const std::array<double, kRingSamples>& ring, double middle) {
  std::vector<double> angles;
  bool first_darkens = true;
  for (int i = 0; i < kRingSamples; ++i) {
    const double here = ring[static_cast<std::size_t>(i)] - middle;
    const double next = ring[static_cast<std::size_t>((i + 1) % kRingSamples)] - middle;
    if ((here >= 0.0) == (next >= 0.0)) continue;
    if (angles.empty()) first_darkens = here >= 0.0;
    angles.push_back(Angle(i) + 2.0 * std::numbers::pi / kRingSamples * here / (here - next));
  }
  if (!first_darkens) std::rotate(angles.begin(), angles.begin() + 1, angles.end());
  return angles;
}

// The angle of the line through two nearly opposite directions, as seen from the first; nothing
// where they are not.
std::optional<double> LineAngle(double first, double second) {
  const double bend = std::remainder(second - first - std::numbers::pi, 2.0 * std::numbers::pi);
  if (std::abs(bend) > kMostBend) return std::nullopt;
  return first + bend / 2.0;
}

}  // namespace

double LevelAt(const cv::Mat& picture, const Eigen::Vector2d& pixel) {
  const double x = std::clamp(pixel.x(), 0.0, picture.cols - 1.0);
  const double y = std::clamp(pixel.y(), 0.0, picture.rows - 1.0);
  const int column = std::min(static_cast<int>(x), std::max(picture.cols - 2, 0));
  const int row = std::min(static_cast<int>(y), std::max(picture.rows - 2, 0));
  const double u = x - column;
  const double v = y - row;
  const auto* above = picture.ptr<float>(row) + column;
  const auto* below = picture.ptr<float>(std::min(row + 1, picture.rows - 1)) + column;
  const int next = picture.cols > 1 ? 1 : 0;
  return (above[0] * (1.0 - u) + above[next] * u) * (1.0 - v) +
         (below[0] * (1.0 - u) + below[next] * u) * v;
}

std::optional<Saddle> SaddleAt(const cv::Mat& picture, const Eigen::Vector2d& centre,
                               double radius) {
  const auto ring = Ring(picture, centre, radius);
  const auto [low, high] = std::minmax_element(ring.begin(), ring.end());
  const double middle = (*low + *high) / 2.0;
  if (*high - *low < kLeastContrast) return std::nullopt;
  const auto angles = Crossings(ring, middle);
  if (angles.size() != 4) return std::nullopt;
  const auto one = LineAngle(angles[0], angles[2]);
  const auto other = LineAngle(angles[1], angles[3]);
  if (!one || !other) return std::nullopt;
  Saddle saddle;
  saddle.pixel = centre;
  saddle.contrast = *high - *low;
  saddle.edges[0] = {std::cos(*one), std::sin(*one)};
  saddle.edges[1] = {std::cos(*other), std::sin(*other)};
  saddle.edges[2] = -saddle.edges[0];
  saddle.edges[3] = -saddle.edges[1];
  return saddle;
}

std::vector<Saddle> FindSaddles(const cv::Mat& picture) {
  auto peaks = Peaks(SaddleResponse(picture));
  std::vector<std::pair<float, Saddle>> found;
  for (const Peak& peak : peaks)
    if (const auto saddle = SaddleAt(picture, Eigen::Vector2d(peak.column, peak.row), kRing))
      found.emplace_back(peak.response, *saddle);
  if (found.size() > kMostSaddles) {
    std::vector<float> responses;
    for (const auto& entry : found) responses.push_back(entry.first);
    std::nth_element(responses.begin(), responses.begin() + kMostSaddles - 1, responses.end(),
                     std::greater<>());
    const float least = responses[kMostSaddles - 1];
    std::erase_if(found, [&](const auto& entry) { return entry.first < least; });
    found.resize(std::min(found.size(), kMostSaddles));
  }
  std::vector<Saddle> saddles;
  for (const auto& entry : found) saddles.push_back(entry.second);
  return saddles;
}

}  // namespace turnlight::calib::calibrate::board
