#include "calib/calibrate/board/shown_board.h"

#include <algorithm>
#include <map>

#include "base/format.h"

namespace turnlight::calib::calibrate::board {
namespace {

constexpr std::size_t kHardlyAny = 4;  // pictures of another board for each of this one
constexpr std::size_t kManyParts = 5;  // pictures that show the same part and no more

// By how many columns and rows a view's points are apart.
GridSize ExtentOf(const BoardView& view, const Board& board) {
  int left = board.columns, right = -1, top = board.rows, bottom = -1;
  for (const SeenPoint& seen : view.points) {
    const int column = static_cast<int>(seen.point) % board.columns;
    const int row = static_cast<int>(seen.point) / board.columns;
    left = std::min(left, column);
    right = std::max(right, column);
    top = std::min(top, row);
    bottom = std::max(bottom, row);
  }
  const int columns = right - left + 1, rows = bottom - top + 1;
  return {std::max(columns, rows), std::min(columns, rows)};
}

struct Shown {
  std::map<GridSize, std::vector<std::size_t>> others;  // which pictures show it
  std::map<GridSize, std::size_t> parts;                // boards of which that much is seen
  std::size_t views = 0, whole = 0;
};

Shown ShownIn(const std::vector<Result<Detection>>& found, const Board& board) {
  Shown shown;
  const GridSize all{std::max(board.columns, board.rows), std::min(board.columns, board.rows)};
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (!found[i]) continue;
    std::vector<GridSize> others = found[i]->others;
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    for (const GridSize& other : others) shown.others[other].push_back(i);
    for (const DetectedBoard& one : found[i]->boards) {
      const GridSize extent = ExtentOf(one.view, board);
      ++shown.views;
      shown.whole += extent == all;
      ++shown.parts[extent];
    }
  }
  return shown;
}

constexpr const char* kCount =
    "; inner corners are where four squares meet, one less than the squares each way";

}  // namespace

Status CheckShownBoard(const std::vector<std::string>& names,
                       const std::vector<Result<Detection>>& found, const Board& board) {
  if (board.kind != BoardKind::kChessboard) return {};
  const Shown shown = ShownIn(found, board);
  const auto other = std::max_element(
      shown.others.begin(), shown.others.end(),
      [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
  if (other != shown.others.end() && kHardlyAny * shown.whole < other->second.size()) {
    const auto& [size, pictures] = *other;
    return InputError(
        Format("--board %dx%d: %zu of the %zu pictures show a board of %d x %d inner corners "
               "instead (%s%s), and %zu a whole one of %d x %d: is it --board %dx%d? Else leave "
               "those pictures out",
               board.columns, board.rows, pictures.size(), found.size(), size.columns, size.rows,
               names[pictures.front()].c_str(), pictures.size() > 1 ? ", ..." : "", shown.whole,
               board.columns, board.rows, size.columns, size.rows) +
        kCount);
  }
  if (shown.whole > 0 || shown.views < kManyParts) return {};
  GridSize largest;
  for (const auto& [size, count] : shown.parts)
    largest = {std::max(largest.columns, size.columns), std::max(largest.rows, size.rows)};
  const auto part = shown.parts.find(largest);
  if (part == shown.parts.end() || 2 * part->second <= shown.views) return {};
  return InputError(
      Format("--board %dx%d: none of the %zu boards in the pictures shows more than %d x %d "
             "inner corners, and %zu show as many: is it --board %dx%d?",
             board.columns, board.rows, shown.views, largest.columns, largest.rows, part->second,
             largest.columns, largest.rows) +
      kCount);
}

}  // namespace turnlight::calib::calibrate::board
