#include "calib/calibrate/board/marker_layout.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/calibrate/board/homography.h"

namespace turnlight::calib::calibrate::board {
namespace {

constexpr double kInPlace = 0.35;       // of a marker's side in the picture, between its centres
constexpr std::size_t kMostSeeds = 24;  // markers from which a board is grown

Eigen::Vector2d Centre(const Quad& quad) { return (quad[0] + quad[1] + quad[2] + quad[3]) / 4.0; }

double Side(const Quad& quad) {
  double least = (quad[0] - quad[3]).norm();
  for (std::size_t i = 0; i < 3; ++i) least = std::min(least, (quad[i + 1] - quad[i]).norm());
  return least;
}

Quad Square(double x, double y, double side, int turn) {
  const Quad plain{Eigen::Vector2d(x, y), Eigen::Vector2d(x + side, y),
                   Eigen::Vector2d(x + side, y + side), Eigen::Vector2d(x, y + side)};
  Quad turned;
  for (std::size_t i = 0; i < 4; ++i) turned[i] = plain[(i + static_cast<std::size_t>(turn)) % 4];
  return turned;
}

std::map<int, Quad> CharucoPlaces(const Board& board, const MarkerLayout& layout) {
  std::map<int, Quad> places;
  const double margin = (board.spacing - board.marker) / 2.0;
  int id = 0;
  for (int row = 0; row <= board.rows; ++row)
    for (int column = 0; column <= board.columns; ++column) {
      if (((column + row) % 2 == 0) == layout.begins_dark) continue;
      places[id++] = Square((column - 1) * board.spacing + margin,
                            (row - 1) * board.spacing + margin, board.marker, layout.turn);
    }
  return places;
}

// Grows from one marker by those next to it on the board, refitting as it goes.
std::vector<std::size_t> GrowFrom(std::size_t seed, const std::vector<SeenMarker>& seen,
                                  const std::map<int, Quad>& places) {
  std::vector<std::size_t> chosen{seed};
  std::vector<Eigen::Vector2d> from, to;
  const auto add = [&](std::size_t i) {
    const Quad& place = places.at(seen[i].id);
    from.insert(from.end(), place.begin(), place.end());
    to.insert(to.end(), seen[i].corners.begin(), seen[i].corners.end());
  };
  add(seed);
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (i != seed && places.contains(seen[i].id)) others.push_back(i);
  const Eigen::Vector2d origin = Centre(places.at(seen[seed].id));
  std::stable_sort(others.begin(), others.end(), [&](std::size_t a, std::size_t b) {
    return (Centre(places.at(seen[a].id)) - origin).norm() <
           (Centre(places.at(seen[b].id)) - origin).norm();
  });
  for (const std::size_t i : others) {
    const auto homography = FitHomography(from, to);
    if (!homography) return {};
    const bool taken = std::any_of(chosen.begin(), chosen.end(),
                                   [&](std::size_t c) { return seen[c].id == seen[i].id; });
    const Eigen::Vector2d expected = Map(*homography, Centre(places.at(seen[i].id)));
    const double off = (expected - Centre(seen[i].corners)).norm();
    if (taken || !(off < kInPlace * Side(seen[i].corners))) continue;
    chosen.push_back(i);
    add(i);
  }
  return chosen;
}

// Are the markers' corners, too, where the layout has them, and not turned?
bool CornersFit(const std::vector<std::size_t>& chosen, const std::vector<SeenMarker>& seen,
                const std::map<int, Quad>& places) {
  std::vector<Eigen::Vector2d> from, to;
  for (const std::size_t i : chosen) {
    const Quad& place = places.at(seen[i].id);
    from.insert(from.end(), place.begin(), place.end());
    to.insert(to.end(), seen[i].corners.begin(), seen[i].corners.end());
  }
  const auto homography = FitHomography(from, to);
  if (!homography) return false;
  std::size_t good = 0;
  for (std::size_t i = 0; i < from.size(); ++i)
    good +=
        (Map(*homography, from[i]) - to[i]).norm() < kInPlace * Side(seen[chosen[i / 4]].corners);
  constexpr double kMostCorners = 0.9;
  return static_cast<double>(good) >= kMostCorners * static_cast<double>(from.size());
}

}  // namespace

std::vector<MarkerLayout> MarkerLayouts(const Board& board) {
  std::vector<MarkerLayout> layouts;
  if (board.kind == BoardKind::kCharuco) {
    for (const bool begins_dark : {true, false}) layouts.push_back({begins_dark, false, 0});
    return layouts;
  }
  // The same tag is turned otherwise in the dictionaries of AprilTag and of OpenCV.
  for (const bool from_below : {false, true})
    for (const int turn : {0, 2, 1, 3}) layouts.push_back({true, from_below, turn});
  return layouts;
}

std::map<int, Quad> MarkerPlaces(const Board& board, const MarkerLayout& layout) {
  if (board.kind == BoardKind::kCharuco) return CharucoPlaces(board, layout);
  std::map<int, Quad> places;
  for (int row = 0; row < board.rows; ++row)
    for (int column = 0; column < board.columns; ++column) {
      const int line = layout.from_below ? board.rows - 1 - row : row;
      places[line * board.columns + column] =
          Square(column * board.spacing, row * board.spacing, board.marker, layout.turn);
    }
  return places;
}

std::vector<std::size_t> FittingMarkers(const std::vector<SeenMarker>& seen,
                                        const std::map<int, Quad>& places) {
  std::vector<std::size_t> best;
  std::size_t seeds = 0;
  for (std::size_t seed = 0; seed < seen.size() && seeds < kMostSeeds; ++seed) {
    if (!places.contains(seen[seed].id)) continue;
    ++seeds;
    auto chosen = GrowFrom(seed, seen, places);
    if (chosen.size() <= std::max<std::size_t>(best.size(), 1)) continue;
    if (CornersFit(chosen, seen, places)) best = std::move(chosen);
  }
  return best;
}

}  // namespace turnlight::calib::calibrate::board
