#include "calib/calibrate/board/saddle_links.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>

namespace turnlight::calib::calibrate::board {
namespace {

constexpr double kAcross = 0.2;   // a neighbour's distance from the edge's line, of that along it
constexpr double kAligned = 0.9;  // cosine between the line to a neighbour and its own edge
constexpr double kEdgeContrast = 0.3;  // across an edge, of the corners' contrast
constexpr int kNone = -1;

// links[p][k]: the saddle next to p along its edge k.
using Links = std::vector<std::array<int, 4>>;

// The edge of q that leads back to p.
int EdgeTowards(const Saddle& q, const Eigen::Vector2d& direction) {
  int best = kNone;
  double most = kAligned;
  for (int k = 0; k < 4; ++k) {
    const double cosine = q.edges[static_cast<std::size_t>(k)].dot(direction);
    if (cosine > most) {
      most = cosine;
      best = k;
    }
  }
  return best;
}

int NextAlong(const cv::Mat& picture, const std::vector<Saddle>& saddles, std::size_t p, int k) {
  const Eigen::Vector2d& edge = saddles[p].edges[static_cast<std::size_t>(k)];
  std::vector<std::pair<double, std::size_t>> ahead;
  for (std::size_t q = 0; q < saddles.size(); ++q) {
    const Eigen::Vector2d d = saddles[q].pixel - saddles[p].pixel;
    const double along = d.dot(edge);
    if (along <= 0.0 || std::abs(d.x() * edge.y() - d.y() * edge.x()) > kAcross * along) continue;
    ahead.emplace_back(along, q);
  }
  constexpr std::size_t kTries = 4;  // what lies between two corners is noise, and little of it
  const std::size_t count = std::min(ahead.size(), kTries);
  std::partial_sort(ahead.begin(), ahead.begin() + static_cast<std::ptrdiff_t>(count), ahead.end());
  for (std::size_t i = 0; i < count; ++i) {
    const Saddle& q = saddles[ahead[i].second];
    const Eigen::Vector2d back = (saddles[p].pixel - q.pixel).normalized();
    if (EdgeTowards(q, back) == kNone || !IsEdge(picture, saddles[p], q)) continue;
    return static_cast<int>(ahead[i].second);
  }
  return kNone;
}

Links FindLinks(const cv::Mat& picture, const std::vector<Saddle>& saddles) {
  Links links(saddles.size());
  for (std::size_t p = 0; p < saddles.size(); ++p)
    for (int k = 0; k < 4; ++k)
      links[p][static_cast<std::size_t>(k)] = NextAlong(picture, saddles, p, k);
  // Only what both ends agree on.
  Links mutual = links;
  for (std::size_t p = 0; p < saddles.size(); ++p)
    for (int& q : mutual[p]) {
      if (q == kNone) continue;
      const auto& back = links[static_cast<std::size_t>(q)];
      if (std::count(back.begin(), back.end(), static_cast<int>(p)) != 1) q = kNone;
    }
  return mutual;
}

constexpr std::array<std::array<int, 2>, 4> kSteps = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

// All saddles that hang together with the first one, which is at (0, 0) with turn 0.
SaddleGrid Spread(const Links& links, int first, std::vector<bool>& taken) {
  SaddleGrid grid{{{0, 0}, {first, 0}}};
  std::deque<std::pair<int, int>> open{{0, 0}};
  taken[static_cast<std::size_t>(first)] = true;
  while (!open.empty()) {
    const auto here = open.front();
    open.pop_front();
    const Member p = grid[here];
    for (int k = 0; k < 4; ++k) {
      const int q = links[static_cast<std::size_t>(p.saddle)][static_cast<std::size_t>(k)];
      if (q == kNone || taken[static_cast<std::size_t>(q)]) continue;
      const int direction = (k + p.turn) % 4;
      const auto& step = kSteps[static_cast<std::size_t>(direction)];
      const std::pair<int, int> there{here.first + step[0], here.second + step[1]};
      if (grid.contains(there)) continue;
      const auto& back = links[static_cast<std::size_t>(q)];
      const int m = static_cast<int>(std::find(back.begin(), back.end(), p.saddle) - back.begin());
      grid[there] = {q, (direction + 2 - m + 4) % 4};
      taken[static_cast<std::size_t>(q)] = true;
      open.push_back(there);
    }
  }
  return grid;
}

}  // namespace

bool IsEdge(const cv::Mat& picture, const Saddle& p, const Saddle& q) {
  const Eigen::Vector2d along = q.pixel - p.pixel;
  const double length = along.norm();
  const Eigen::Vector2d side =
      Eigen::Vector2d(-along.y(), along.x()) / length * std::clamp(0.12 * length, 1.5, 12.0);
  const double least = kEdgeContrast * std::min(p.contrast, q.contrast);
  int brighter = 0;
  int darker = 0;
  constexpr int kPlaces = 5;
  for (int i = 0; i < kPlaces; ++i) {
    const Eigen::Vector2d middle = p.pixel + along * (0.2 + 0.15 * i);
    const double step = LevelAt(picture, middle + side) - LevelAt(picture, middle - side);
    brighter += step > least;
    darker += step < -least;
  }
  return brighter == kPlaces || darker == kPlaces;
}

std::vector<SaddleGrid> LinkSaddles(const cv::Mat& picture, const std::vector<Saddle>& saddles) {
  const Links links = FindLinks(picture, saddles);
  std::vector<bool> taken(saddles.size(), false);
  std::vector<SaddleGrid> grids;
  for (std::size_t first = 0; first < saddles.size(); ++first) {
    if (taken[first]) continue;
    SaddleGrid grid = Spread(links, static_cast<int>(first), taken);
    if (grid.size() >= 4) grids.push_back(std::move(grid));
  }
  return grids;
}

}  // namespace turnlight::calib::calibrate::board
