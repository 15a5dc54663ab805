#include "calib/calibrate/board/number_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/format.h"
#include "calib/calibrate/board/homography.h"
#include "calib/calibrate/board/saddle_points.h"

namespace turnlight::calib::calibrate::board {
namespace {

constexpr double kEndAt = 0.12;          // of a square, around where the last one must end
constexpr double kEndAtExactly = 0.06;   // likewise, where squares of both colours end
constexpr double kMostSquares = 0.65;    // of one colour end there,
constexpr double kFewSquares = 0.34;     // and of the other colour no more, or exactly there
constexpr double kLikeOneAnother = 0.3;  // of the contrast, between what is beyond either colour

// Where the level along a line outwards from the middle of the last square first passes half way
// between dark and bright; in squares from its inner edge, 2 where it does not.
double EndOfSquare(const cv::Mat& picture, const Eigen::Matrix3d& homography,
                   const Eigen::Vector2d& inner, const Eigen::Vector2d& outwards, double middle) {
  const double here = LevelAt(picture, Map(homography, inner + 0.5 * outwards)) - middle;
  for (double t = 0.5; t < 1.5; t += 0.02) {
    const double next = LevelAt(picture, Map(homography, inner + (t + 0.02) * outwards)) - middle;
    if ((next >= 0.0) != (here >= 0.0)) return t + 0.01;
  }
  return 2.0;
}

// Does the print end one square beyond the right side of the lattice? So it does where the squares
// of one colour end there, and what follows them is like what follows those of the other: paper or
// whatever is behind, not further squares that take turns.
bool EndsAtRight(const cv::Mat& picture, const CornerLattice& lattice) {
  std::vector<Eigen::Vector2d> places, pixels;
  const int nearest = std::max(0, lattice.columns - 4);
  for (int row = 0; row < lattice.rows; ++row)
    for (int column = nearest; column < lattice.columns; ++column) {
      if (!lattice.Has(column, row)) continue;
      places.emplace_back(column, row);
      pixels.push_back(lattice.At(column, row));
    }
  const auto homography = FitHomography(places, pixels);
  if (!homography) return false;
  const int last = lattice.columns - 1;
  std::array<double, 2> squares{}, ends{}, exact{}, inside{},
      beyond{};  // of bright ones, of dark ones
  for (int row = 0; row + 1 < lattice.rows; ++row) {
    if (!lattice.Has(last, row) || !lattice.Has(last, row + 1)) continue;
    const Eigen::Vector2d inner(last, row + 0.5);
    const Eigen::Vector2d outwards(1.0, 0.0);
    const auto level = [&](double t) {
      return LevelAt(picture, Map(*homography, inner + t * outwards));
    };
    const double end =
        EndOfSquare(picture, *homography, inner, outwards, (level(0.5) + level(-0.5)) / 2.0);
    const std::size_t colour = level(0.5) < level(-0.5);
    ++squares[colour];
    ends[colour] += std::abs(end - 1.0) <= kEndAt;
    exact[colour] += std::abs(end - 1.0) <= kEndAtExactly;
    inside[colour] += level(0.5);
    beyond[colour] += level(1.4);
  }
  if (squares[0] < 2 || squares[1] < 2) return false;
  const double contrast = inside[0] / squares[0] - inside[1] / squares[1];
  const double difference = beyond[0] / squares[0] - beyond[1] / squares[1];
  if (std::abs(difference) > kLikeOneAnother * contrast) return false;
  const double few = std::min(ends[0] / squares[0], ends[1] / squares[1]);
  const double most = std::max(ends[0] / squares[0], ends[1] / squares[1]);
  // Where squares of both colours end, it may be the edge of something in front of them.
  return (most >= kMostSquares && few <= kFewSquares) ||
         std::max(exact[0] / squares[0], exact[1] / squares[1]) >= kMostSquares;
}

// At which of the board's columns a lattice of fewer begins; -1 where it cannot be told, -2 where
// it ends on both sides.
constexpr int kNoEnd = -1;
constexpr int kTwoEnds = -2;
int FirstColumn(const cv::Mat& picture, const CornerLattice& lattice, int columns) {
  if (lattice.columns == columns) return 0;
  const bool right = EndsAtRight(picture, lattice);
  const bool left = EndsAtRight(picture, Turned(lattice, 2));
  if (right && left) return kTwoEnds;
  if (right) return columns - lattice.columns;
  return left ? 0 : kNoEnd;
}

Numbering OtherSize(const CornerLattice& lattice, const Board& board) {
  const GridSize size{std::max(lattice.columns, lattice.rows),
                      std::min(lattice.columns, lattice.rows)};
  return {std::nullopt,
          Format("the picture shows %d x %d inner corners, the board is said to have %d x %d",
                 size.columns, size.rows, board.columns, board.rows),
          size};
}

// The lattice within all of the board's points.
CornerLattice Placed(const CornerLattice& lattice, const Board& board, int column, int row) {
  CornerLattice placed;
  placed.columns = board.columns;
  placed.rows = board.rows;
  placed.corners.resize(board.PointCount());
  placed.begins_dark = lattice.begins_dark == ((column + row) % 2 == 0);
  for (int y = 0; y < lattice.rows; ++y)
    for (int x = 0; x < lattice.columns; ++x)
      placed.corners[placed.Index(column + x, row + y)] = lattice.corners[lattice.Index(x, y)];
  return placed;
}

// Lower is better: dark before point 0, then its place in the picture.
std::pair<bool, double> Preference(const CornerLattice& lattice) {
  std::vector<Eigen::Vector2d> places, pixels;
  for (int row = 0; row < lattice.rows; ++row)
    for (int column = 0; column < lattice.columns; ++column)
      if (lattice.Has(column, row)) {
        places.emplace_back(column, row);
        pixels.push_back(lattice.At(column, row));
      }
  const auto homography = FitHomography(places, pixels);
  const Eigen::Vector2d origin = homography ? Map(*homography, {0.0, 0.0}) : pixels.front();
  return {!lattice.begins_dark, origin.sum()};
}

}  // namespace

Numbering NumberLattice(const cv::Mat& picture, const CornerLattice& lattice, const Board& board) {
  std::vector<CornerLattice> ways;
  bool may_be_part = false;
  for (int turn = 0; turn < 4; ++turn) {
    const CornerLattice turned = Turned(lattice, turn);
    if (turned.columns > board.columns || turned.rows > board.rows) continue;
    const int column = FirstColumn(picture, turned, board.columns);
    const int row = FirstColumn(picture, Turned(turned, 1), board.rows);
    may_be_part = may_be_part || (column != kTwoEnds && row != kTwoEnds);
    if (column >= 0 && row >= 0) ways.push_back(Placed(turned, board, column, row));
  }
  if (ways.empty() && !may_be_part) return OtherSize(lattice, board);
  if (ways.empty())
    return {std::nullopt,
            Format("a part of a board, %d x %d inner corners, was left out: which of its "
                   "%d x %d they are cannot be told, as none of its ends shows",
                   lattice.columns, lattice.rows, board.columns, board.rows),
            std::nullopt};
  const CornerLattice& best =
      *std::min_element(ways.begin(), ways.end(),
                        [](const auto& a, const auto& b) { return Preference(a) < Preference(b); });
  return {best, "", std::nullopt};
}

std::vector<std::vector<std::size_t>> SameLookingNumberings(const Board& board) {
  CornerLattice numbers;  // whose "pixels" are the points' numbers
  numbers.columns = board.columns;
  numbers.rows = board.rows;
  for (std::size_t i = 0; i < board.PointCount(); ++i)
    numbers.corners.emplace_back(Eigen::Vector2d(static_cast<double>(i), 0.0));
  std::vector<std::vector<std::size_t>> ways;
  const int turns = board.kind == BoardKind::kChessboard ? 4 : 1;
  for (int turn = 0; turn < turns; ++turn) {
    const CornerLattice turned = Turned(numbers, turn);
    if (turned.columns != board.columns || turned.begins_dark != numbers.begins_dark) continue;
    std::vector<std::size_t> way;
    for (const auto& corner : turned.corners) way.push_back(static_cast<std::size_t>(corner->x()));
    ways.push_back(way);
  }
  return ways;
}

std::vector<Pose> SameLookingTurns(const Board& board) {
  const auto points = BoardPoints(board);
  std::vector<Pose> turns;
  for (const std::vector<std::size_t>& way : SameLookingNumberings(board)) {
    Pose turn;
    turn.translation = points[way[0]];
    turn.rotation.col(0) = (points[way[1]] - points[way[0]]).normalized();
    turn.rotation.col(1) = Eigen::Vector3d::UnitZ().cross(turn.rotation.col(0));
    turns.push_back(turn);
  }
  return turns;
}

}  // namespace turnlight::calib::calibrate::board
