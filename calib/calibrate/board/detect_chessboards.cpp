#include "calib/calibrate/board/detect_chessboards.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "base/format.h"
#include "calib/calibrate/board/find_lattices.h"
#include "calib/calibrate/board/number_lattice.h"
#include "calib/calibrate/board/refine_corners.h"
#include "calib/calibrate/board/view_quality.h"
#include "calib/calibrate/board/whole_boards.h"

namespace turnlight::calib::calibrate::board {
namespace {

constexpr int kCoarsest = 100;      // pixels; no scale is tried below
constexpr double kSamePlace = 0.4;  // of the distance to the next corner
constexpr double kSparse = 0.5;     // of the corners of the line next to it

constexpr double kEven = 0.35;  // of a square's width, from its edge

struct Candidate {
  CornerLattice lattice;  // as found, or numbered
  bool numbered = false;
  std::string reason;             // why not
  std::optional<GridSize> other;  // it is a board of another size
};

// Without the sparsest outer line, if it has less than half as many corners as the one next to it.
bool PeelSparseLine(CornerLattice& lattice) {
  for (int turn = 0; turn < 4; ++turn) {
    CornerLattice turned = Turned(lattice, turn);
    if (turned.columns < 3) continue;
    int outer = 0;
    int next = 0;
    for (int row = 0; row < turned.rows; ++row) {
      outer += turned.Has(turned.columns - 1, row);
      next += turned.Has(turned.columns - 2, row);
    }
    if (outer >= kSparse * next) continue;
    for (int row = 0; row < turned.rows; ++row)
      turned.corners[turned.Index(turned.columns - 1, row)].reset();
    lattice = Trimmed(turned);
    return true;
  }
  return false;
}

bool TooLarge(const CornerLattice& lattice, const Board& board) {
  return std::max(lattice.columns, lattice.rows) > std::max(board.columns, board.rows) ||
         std::min(lattice.columns, lattice.rows) > std::min(board.columns, board.rows);
}

Candidate Judge(const cv::Mat& levelled, CornerLattice lattice, const Board& board) {
  RefineCorners(levelled, lattice);
  lattice = Trimmed(lattice);
  if (lattice.columns >= 2 && lattice.rows >= 2) DropOutliers(lattice);
  lattice = Trimmed(lattice);
  Candidate candidate{lattice, false, "", std::nullopt};
  if (lattice.columns < 2 || lattice.rows < 2 || lattice.Count() < 4) return candidate;
  auto numbered = NumberLattice(levelled, lattice, board);
  while (!numbered.lattice && TooLarge(lattice, board) && PeelSparseLine(lattice))
    numbered = NumberLattice(levelled, lattice, board);
  if (numbered.lattice) return {*numbered.lattice, true, "", std::nullopt};
  candidate.reason = numbered.why_not;
  candidate.other = numbered.other;
  return candidate;
}

// Lattices of all scales, in pixels of the picture.
std::vector<CornerLattice> LatticesOfAllScales(const cv::Mat& levelled) {
  std::vector<CornerLattice> all;
  cv::Mat scaled = levelled;
  for (double scale = 1.0; std::min(scaled.cols, scaled.rows) >= kCoarsest || scale == 1.0;
       scale *= 2.0) {
    for (CornerLattice& lattice : FindLattices(scaled, FindSaddles(scaled))) {
      for (auto& corner : lattice.corners)
        if (corner) corner = (corner->array() + 0.5) * scale - 0.5;
      all.push_back(std::move(lattice));
    }
    cv::Mat half;
    cv::resize(scaled, half, {scaled.cols / 2, scaled.rows / 2}, 0.0, 0.0, cv::INTER_AREA);
    scaled = half;
  }
  return all;
}

bool Overlap(const CornerLattice& a, const CornerLattice& b) {
  int same = 0;
  for (int row = 0; row < a.rows; ++row)
    for (int column = 0; column < a.columns; ++column) {
      if (!a.Has(column, row)) continue;
      const double near = std::max(2.0, kSamePlace * FreeReach(a, column, row));
      same += std::any_of(b.corners.begin(), b.corners.end(), [&](const auto& corner) {
        return corner && (*corner - a.At(column, row)).norm() < near;
      });
    }
  return same >= 2;
}

// Is it the same board and not numbered, with a further row or column?
bool GoesBeyond(const Candidate& candidate, const Candidate& numbered) {
  constexpr double kMostOfALine = 0.7;
  const CornerLattice& board = numbered.lattice;
  return !candidate.numbered &&
         static_cast<double>(candidate.lattice.Count()) >=
             static_cast<double>(board.Count()) +
                 kMostOfALine * std::min(board.columns, board.rows) &&
         Overlap(board, candidate.lattice);
}

// The best of those that lie over each other: numbered, then with the most corners, then of the
// finest scale.
std::vector<Candidate> BestApart(const std::vector<Candidate>& all) {
  // A board of the size asked for is none if another scale sees that it goes on.
  std::vector<Candidate> candidates;
  for (const Candidate& candidate : all) {
    const auto beyond = [&](const Candidate& other) { return GoesBeyond(other, candidate); };
    if (!candidate.numbered || std::none_of(all.begin(), all.end(), beyond))
      candidates.push_back(candidate);
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
    if (a.numbered != b.numbered) return a.numbered;
    return a.lattice.Count() > b.lattice.Count();
  });
  std::vector<Candidate> best;
  for (Candidate& candidate : candidates) {
    const auto overlaps = [&](const Candidate& kept) {
      return Overlap(kept.lattice, candidate.lattice);
    };
    if (std::none_of(best.begin(), best.end(), overlaps)) best.push_back(std::move(candidate));
  }
  return best;
}

// A part of the board of another size that the picture shows may look like a part of this one.
bool MayBePartOf(const CornerLattice& lattice, const std::vector<GridSize>& others) {
  if (lattice.Count() == 0) return false;
  const CornerLattice part = Trimmed(lattice);
  const int longer = std::max(part.columns, part.rows), shorter = std::min(part.columns, part.rows);
  const bool whole = part.columns == lattice.columns && part.rows == lattice.rows;
  return !whole && std::any_of(others.begin(), others.end(), [&](const GridSize& other) {
    return longer <= other.columns && shorter <= other.rows;
  });
}

DetectedBoard BoardFrom(const cv::Mat& picture, const cv::Mat& levelled,
                        const CornerLattice& lattice) {
  DetectedBoard found;
  found.edge_sigma = EdgeSigma(levelled, EdgesOf(lattice, kEven));
  const double spread = SpreadOf(found.edge_sigma);
  for (std::size_t i = 0; i < lattice.corners.size(); ++i)
    if (lattice.corners[i]) found.view.points.push_back({i, *lattice.corners[i], spread});
  found.saturated = SaturatedShare(picture, levelled, found.view);
  return found;
}

}  // namespace

Detection DetectChessboards(const cv::Mat& picture, const cv::Mat& levelled, const Board& board) {
  std::vector<Candidate> candidates;
  for (CornerLattice& lattice : LatticesOfAllScales(levelled))
    candidates.push_back(Judge(levelled, std::move(lattice), board));
  const auto whole = [&](const Candidate& candidate) {
    return candidate.numbered && candidate.lattice.Count() == board.PointCount();
  };
  const auto other = [](const Candidate& candidate) { return candidate.other.has_value(); };
  // The whole boards' detectors are slow, and a board of another size is no board of this one.
  if (std::none_of(candidates.begin(), candidates.end(), whole) &&
      std::none_of(candidates.begin(), candidates.end(), other)) {
    cv::Mat bytes;
    levelled.convertTo(bytes, CV_8U);
    if (auto lattice = FindWholeBoard(bytes, board.columns, board.rows))
      candidates.push_back(Judge(levelled, std::move(*lattice), board));
  }
  Detection detection;
  std::vector<std::string> left_out;
  const std::vector<Candidate> best = BestApart(candidates);
  for (const Candidate& candidate : best)
    if (candidate.other) detection.others.push_back(*candidate.other);
  for (const Candidate& candidate : best) {
    if (candidate.numbered && !MayBePartOf(candidate.lattice, detection.others))
      detection.boards.push_back(BoardFrom(picture, levelled, candidate.lattice));
    else if (!candidate.reason.empty())
      left_out.push_back(candidate.reason);
  }
  detection.remarks = left_out;
  return detection;
}

}  // namespace turnlight::calib::calibrate::board
