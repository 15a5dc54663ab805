#include "calib/calibrate/probe/peaks.h"

#include <algorithm>

namespace turnlight::calib::calibrate::probe {
namespace {

// Sets of pixels under flooding; the root of each knows its highest peak.
class Basins {
 public:
  explicit Basins(std::size_t count) : parent_(count, -1), peak_(count, -1) {}
  bool Wet(int pixel) const { return parent_[pixel] >= 0; }
  void Add(int pixel, int peak) {
    parent_[pixel] = pixel;
    peak_[pixel] = peak;
  }
  int Root(int pixel) {
    while (parent_[pixel] != pixel) pixel = parent_[pixel] = parent_[parent_[pixel]];
    return pixel;
  }
  int& PeakOf(int root) { return peak_[root]; }
  void Join(int root, int other) { parent_[other] = root; }

 private:
  std::vector<int> parent_, peak_;
};

}  // namespace

std::vector<Peak> FindPeaks(const cv::Mat1f& map, const cv::Mat1b& region, float floor, float depth,
                            float depth_min) {
  std::vector<int> order;
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.cols; ++column)
      if (region(row, column) && map(row, column) > floor) order.push_back(row * map.cols + column);
  const auto value = [&](int pixel) { return map(pixel / map.cols, pixel % map.cols); };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return value(a) > value(b); });

  Basins basins(map.total());
  std::vector<Peak> peaks;
  std::vector<bool> counts;
  for (const int pixel : order) {
    const int row = pixel / map.cols, column = pixel % map.cols;
    const float level = value(pixel);
    int root = -1;
    for (int y = std::max(row - 1, 0); y <= std::min(row + 1, map.rows - 1); ++y) {
      for (int x = std::max(column - 1, 0); x <= std::min(column + 1, map.cols - 1); ++x) {
        if (!basins.Wet(y * map.cols + x)) continue;
        int other = basins.Root(y * map.cols + x);
        if (root < 0) root = other;
        if (other == root) continue;
        // Peaks are numbered from the highest down.
        if (basins.PeakOf(other) < basins.PeakOf(root)) std::swap(root, other);
        Peak& higher = peaks[basins.PeakOf(root)];
        Peak& lower = peaks[basins.PeakOf(other)];
        const float stands = lower.height - level;
        if (stands >= std::max(depth * lower.height, depth_min)) {
          higher.saddle = std::max(higher.saddle, level);
          lower.saddle = std::max(lower.saddle, level);
        } else {
          counts[basins.PeakOf(other)] = false;
        }
        basins.Join(root, other);
      }
    }
    if (root < 0) {
      peaks.push_back({{column, row}, level, 0.0f});
      counts.push_back(true);
      basins.Add(pixel, static_cast<int>(peaks.size()) - 1);
    } else {
      basins.Add(pixel, -1);
      basins.Join(root, pixel);
    }
  }
  std::vector<Peak> counting;
  for (std::size_t i = 0; i < peaks.size(); ++i)
    if (counts[i]) counting.push_back(peaks[i]);
  return counting;
}

cv::Mat1b FloodFrom(const cv::Mat1f& map, const cv::Mat1b& region, cv::Point start, float level) {
  cv::Mat1b flooded(map.size(), uchar{0});
  std::vector<cv::Point> next{start};
  flooded(start) = 255;
  while (!next.empty()) {
    const cv::Point at = next.back();
    next.pop_back();
    for (int y = std::max(at.y - 1, 0); y <= std::min(at.y + 1, map.rows - 1); ++y) {
      for (int x = std::max(at.x - 1, 0); x <= std::min(at.x + 1, map.cols - 1); ++x) {
        if (flooded(y, x) || !region(y, x) || !(map(y, x) >= level)) continue;
        flooded(y, x) = 255;
        next.push_back({x, y});
      }
    }
  }
  return flooded;
}

}  // namespace turnlight::calib::calibrate::probe
