#include "estimator/observe/intensity_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/angles.h"
#include "base/parallel.h"

namespace turnlight::estimator::observe {
namespace {

constexpr int kRows = 180, kColumns = 360;
constexpr double kSmoothingDeg = 2.0;
constexpr float kUnseen = std::numeric_limits<float>::quiet_NaN();

struct Cells {
  cv::Mat1d sum = cv::Mat1d::zeros(kRows, kColumns);
  cv::Mat1d count = cv::Mat1d::zeros(kRows, kColumns);
};

Cells Plot(const Observations& all) {
  Cells cells;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all.pixel[i] == Observations::kNoPixel) continue;
    const double x = all.mirrored[0][i], y = all.mirrored[1][i], z = all.mirrored[2][i];
    const double azimuth = RadToDeg(std::atan2(y, x));
    const double zenith = RadToDeg(std::acos(std::clamp(z, -1.0, 1.0)));
    const int column = static_cast<int>(std::floor(azimuth + 360.0)) % kColumns;
    const int row = std::min(static_cast<int>(zenith), kRows - 1);
    double grey = 0.0;
    for (int c = 0; c < all.channels; ++c) grey += static_cast<double>(all.radiance[c][i]);
    cells.sum(row, column) += grey / all.channels * all.radiance_unit;
    cells.count(row, column) += 1.0;
  }
  return cells;
}

// The Gaussian-weighted mean of the samples around a cell. Azimuth cells shrink towards the poles,
// so the window there is wider in columns.
float Smoothed(const Cells& cells, int row, int column) {
  const int reach = static_cast<int>(std::ceil(2.0 * kSmoothingDeg));
  const double sine = std::sin(DegToRad(row + 0.5));
  const int wide =
      std::min(static_cast<int>(std::ceil(reach / std::max(sine, 1e-3))), kColumns / 2);
  const Eigen::Vector3d here = MapDirection(row, column);
  const double falloff = 0.5 / (DegToRad(kSmoothingDeg) * DegToRad(kSmoothingDeg));
  double sum = 0.0, weights = 0.0;
  for (int r = std::max(row - reach, 0); r <= std::min(row + reach, kRows - 1); ++r)
    for (int d = -wide; d < wide; ++d) {
      const int c = (column + d + kColumns) % kColumns;
      if (cells.count(r, c) == 0.0) continue;
      const double squared = (MapDirection(r, c) - here).squaredNorm();
      const double weight = std::exp(-falloff * squared);
      sum += weight * cells.sum(r, c);
      weights += weight * cells.count(r, c);
    }
  return weights > 0.0 ? static_cast<float>(sum / weights) : kUnseen;
}

}  // namespace

Eigen::Vector3d MapDirection(int row, int column) {
  const double zenith = DegToRad(row + 0.5), azimuth = DegToRad(column + 0.5);
  return {std::sin(zenith) * std::cos(azimuth), std::sin(zenith) * std::sin(azimuth),
          std::cos(zenith)};
}

IntensityMap MakeIntensityMap(const Observations& observations) {
  const Cells cells = Plot(observations);
  IntensityMap map{cv::Mat1f(kRows, kColumns, kUnseen)};
  ParallelFor(kRows, [&](std::size_t r) {
    const int row = static_cast<int>(r);
    for (int column = 0; column < kColumns; ++column)
      if (cells.count(row, column) > 0.0) map.intensity(row, column) = Smoothed(cells, row, column);
  });
  return map;
}

std::vector<MapPoint> HighIntensityArea(const IntensityMap& map, double share) {
  float low = std::numeric_limits<float>::infinity(), high = -low;
  for (const float value : map.intensity)
    if (!std::isnan(value)) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  const double threshold = low + share * (high - low);
  std::vector<MapPoint> points;
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      const double value = static_cast<double>(map.intensity(row, column));
      if (value >= threshold) points.push_back({MapDirection(row, column), value});
    }
  std::stable_sort(points.begin(), points.end(),
                   [](const MapPoint& a, const MapPoint& b) { return a.intensity > b.intensity; });
  return points;
}

std::vector<MapPoint> LeaderClustering(const std::vector<MapPoint>& points, double radius) {
  const double cosine = std::cos(radius);
  std::vector<MapPoint> leaders;
  for (const MapPoint& point : points) {
    const bool joins = std::any_of(leaders.begin(), leaders.end(), [&](const MapPoint& leader) {
      return leader.direction.dot(point.direction) >= cosine;
    });
    if (!joins) leaders.push_back(point);
  }
  return leaders;
}

}  // namespace turnlight::estimator::observe
