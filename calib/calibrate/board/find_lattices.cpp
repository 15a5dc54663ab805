#include "calib/calibrate/board/find_lattices.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "calib/calibrate/board/homography.h"
#include "calib/calibrate/board/saddle_links.h"

namespace turnlight::calib::calibrate::board {
namespace {

constexpr double kSeedFit = 0.06;   // of nine corners by a homography, of their distance
constexpr double kGrowFit = 0.18;   // of a new corner from where it is expected, likewise
constexpr int kReach = 3;           // rows and columns around, from which it is expected
constexpr double kSameEdge = 0.85;  // cosine between an edge and the direction of its row

using Where = std::pair<int, int>;

constexpr std::array<Where, 4> kAround = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

Where Next(const Where& at, const Where& step, int times = 1) {
  return {at.first + times * step.first, at.second + times * step.second};
}

class Grower {
 public:
  Grower(const cv::Mat& picture, const std::vector<Saddle>& saddles)
      : picture_(picture), saddles_(saddles), used_(saddles.size(), false) {}

  // Takes one lattice out of linked saddles; empty when there is no more.
  SaddleGrid Take(const SaddleGrid& linked) {
    SaddleGrid grid = BestSeed(linked);
    if (grid.empty()) return grid;
    for (const auto& [at, member] : grid) used_[static_cast<std::size_t>(member.saddle)] = true;
    while (GrowOnce(grid)) {
    }
    return grid;
  }

 private:
  const Eigen::Vector2d& Pixel(const Member& member) const {
    return saddles_[static_cast<std::size_t>(member.saddle)].pixel;
  }
  SaddleGrid BestSeed(const SaddleGrid& linked) const;
  bool GrowOnce(SaddleGrid& grid);
  std::optional<Member> Fitting(const SaddleGrid& grid, const Where& at) const;

  const cv::Mat& picture_;
  const std::vector<Saddle>& saddles_;
  std::vector<bool> used_;
};

// The three by three unused saddles that a homography fits best.
SaddleGrid Grower::BestSeed(const SaddleGrid& linked) const {
  SaddleGrid best;
  double least = kSeedFit;
  for (const auto& [centre, middle] : linked) {
    SaddleGrid block;
    std::vector<Eigen::Vector2d> places, pixels;
    for (int row = -1; row <= 1; ++row)
      for (int column = -1; column <= 1; ++column) {
        const auto found = linked.find({centre.first + column, centre.second + row});
        if (found == linked.end() || used_[static_cast<std::size_t>(found->second.saddle)])
          continue;
        block.insert(*found);
        places.emplace_back(column, row);
        pixels.push_back(Pixel(found->second));
      }
    if (block.size() < 9) continue;
    const auto homography = FitHomography(places, pixels);
    if (!homography) continue;
    double worst = 0.0;
    for (std::size_t i = 0; i < places.size(); ++i)
      worst = std::max(worst, (Map(*homography, places[i]) - pixels[i]).norm());
    double spacing = std::numeric_limits<double>::infinity();
    for (const std::size_t i : {1, 3, 5, 7})
      spacing = std::min(spacing, (pixels[i] - pixels[4]).norm());
    // Half a pixel is what a saddle is known to.
    const double fit = std::max(worst - 0.7, 0.0) / spacing;
    if (fit < least) {
      least = fit;
      best = block;
    }
  }
  return best;
}

// The unused saddle nearest to where the corners around expect one, if it fits.
std::optional<Member> Grower::Fitting(const SaddleGrid& grid, const Where& at) const {
  std::vector<Eigen::Vector2d> places, pixels;
  for (int row = -kReach; row <= kReach; ++row)
    for (int column = -kReach; column <= kReach; ++column) {
      const auto found = grid.find({at.first + column, at.second + row});
      if (found == grid.end()) continue;
      places.emplace_back(column, row);
      pixels.push_back(Pixel(found->second));
    }
  if (places.size() < 6) return std::nullopt;
  const auto homography = FitHomography(places, pixels);
  if (!homography) return std::nullopt;
  const Eigen::Vector2d expected = Map(*homography, {0.0, 0.0});
  const Eigen::Vector2d row_step = Map(*homography, {0.5, 0.0}) - Map(*homography, {-0.5, 0.0});
  const Eigen::Vector2d column_step = Map(*homography, {0.0, 0.5}) - Map(*homography, {0.0, -0.5});
  double nearest = 1.0 + kGrowFit * std::min(row_step.norm(), column_step.norm());
  if (!std::isfinite(nearest)) return std::nullopt;
  std::optional<Member> best;
  for (std::size_t i = 0; i < saddles_.size(); ++i) {
    const double distance = (saddles_[i].pixel - expected).norm();
    if (used_[i] || !(distance < nearest)) continue;
    for (int turn = 0; turn < 4; ++turn) {
      const auto& along = saddles_[i].edges[static_cast<std::size_t>((4 - turn) % 4)];
      const auto& down = saddles_[i].edges[static_cast<std::size_t>((5 - turn) % 4)];
      if (along.dot(row_step.normalized()) < kSameEdge ||
          down.dot(column_step.normalized()) < kSameEdge)
        continue;
      best = Member{static_cast<int>(i), turn};
      nearest = distance;
    }
  }
  return best;
}

bool Grower::GrowOnce(SaddleGrid& grid) {
  std::vector<Where> empty;
  for (const auto& [at, member] : grid)
    for (const Where& step : kAround)
      if (!grid.contains(Next(at, step))) empty.push_back(Next(at, step));
  std::sort(empty.begin(), empty.end());
  empty.erase(std::unique(empty.begin(), empty.end()), empty.end());
  const auto& [origin, first] = *grid.begin();
  bool grown = false;
  for (const Where& at : empty) {
    const auto member = Fitting(grid, at);
    if (!member) continue;
    // Dark and bright take turns from corner to corner.
    if ((member->turn + at.first + at.second - first.turn - origin.first - origin.second) % 2 != 0)
      continue;
    const auto joined = [&](const Where& step) {
      const auto found = grid.find(Next(at, step));
      return found != grid.end() &&
             IsEdge(picture_, saddles_[static_cast<std::size_t>(found->second.saddle)],
                    saddles_[static_cast<std::size_t>(member->saddle)]);
    };
    if (std::none_of(kAround.begin(), kAround.end(), joined)) continue;
    grid[at] = *member;
    used_[static_cast<std::size_t>(member->saddle)] = true;
    grown = true;
  }
  return grown;
}

CornerLattice LatticeOf(const std::vector<Saddle>& saddles, const SaddleGrid& grid) {
  int left = grid.begin()->first.first, right = left;
  int top = grid.begin()->first.second, bottom = top;
  for (const auto& [at, member] : grid) {
    left = std::min(left, at.first);
    right = std::max(right, at.first);
    top = std::min(top, at.second);
    bottom = std::max(bottom, at.second);
  }
  CornerLattice lattice;
  lattice.columns = right - left + 1;
  lattice.rows = bottom - top + 1;
  lattice.corners.resize(static_cast<std::size_t>(lattice.columns) *
                         static_cast<std::size_t>(lattice.rows));
  for (const auto& [at, member] : grid)
    lattice.corners[lattice.Index(at.first - left, at.second - top)] =
        saddles[static_cast<std::size_t>(member.saddle)].pixel;
  // With an even turn the square after a corner (and that before it) is dark.
  const auto& [at, member] = *grid.begin();
  lattice.begins_dark = (member.turn + at.first - left + at.second - top) % 2 == 0;
  return lattice;
}

// A corner that only one neighbour speaks for may be anything; ends when all have two.
void DropLoose(CornerLattice& lattice) {
  for (bool changed = true; changed;) {
    changed = false;
    for (int row = 0; row < lattice.rows; ++row)
      for (int column = 0; column < lattice.columns; ++column) {
        if (!lattice.Has(column, row)) continue;
        int neighbours = 0;
        for (const Where& step : kAround)
          neighbours += lattice.Has(column + step.first, row + step.second);
        if (neighbours >= 2) continue;
        lattice.corners[lattice.Index(column, row)].reset();
        changed = true;
      }
  }
}

}  // namespace

std::vector<CornerLattice> FindLattices(const cv::Mat& picture,
                                        const std::vector<Saddle>& saddles) {
  auto grids = LinkSaddles(picture, saddles);
  std::stable_sort(grids.begin(), grids.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  Grower grower(picture, saddles);
  std::vector<CornerLattice> lattices;
  for (const SaddleGrid& linked : grids)
    for (SaddleGrid grid = grower.Take(linked); !grid.empty(); grid = grower.Take(linked)) {
      CornerLattice lattice = LatticeOf(saddles, grid);
      DropLoose(lattice);
      lattices.push_back(Trimmed(lattice));
    }
  std::stable_sort(lattices.begin(), lattices.end(),
                   [](const auto& a, const auto& b) { return a.Count() > b.Count(); });
  return lattices;
}

}  // namespace turnlight::calib::calibrate::board
