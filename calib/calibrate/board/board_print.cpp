#include "calib/calibrate/board/board_print.h"

#include <cmath>

#include "base/format.h"
#include "calib/calibrate/board/marker_dictionary.h"

namespace turnlight::calib::calibrate::board {
namespace {

constexpr int kMostAcross = 1000;  // bounds memory; printed boards have some ten

int MarkerCount(const Board& board) {
  if (board.kind == BoardKind::kChessboard) return 0;
  if (board.kind == BoardKind::kAprilTagGrid) return board.columns * board.rows;
  return (board.columns + 1) * (board.rows + 1) / 2;
}

Status CheckMarkers(const Board& board) {
  if (!(board.marker > 0.0 && board.marker < board.spacing))
    return InputError("a board's marker of " + NumberText(board.marker) +
                      " must be above 0 and below the distance between points, " +
                      NumberText(board.spacing));
  const auto dictionary = FindMarkerDictionary(board.dictionary);
  if (!dictionary) return Forward(dictionary);
  const int has = (*dictionary)->bytesList.rows;
  if (MarkerCount(board) > has)
    return InputError(Format("a board of %d x %d needs %d markers, dictionary \"%s\" has %d",
                             board.columns, board.rows, MarkerCount(board),
                             board.dictionary.c_str(), has));
  return {};
}

}  // namespace

Status CheckBoard(const Board& board) {
  for (const int count : {board.columns, board.rows})
    if (count < 2 || count > kMostAcross)
      return InputError(Format("a board of %d x %d is not possible (allowed: 2 to %d each)",
                               board.columns, board.rows, kMostAcross));
  if (!(board.spacing > 0.0 && std::isfinite(board.spacing)))
    return InputError("a board's distance between points must be above 0, not " +
                      NumberText(board.spacing));
  if (board.kind != BoardKind::kChessboard) return CheckMarkers(board);
  if (board.marker != 0.0 || !board.dictionary.empty())
    return InputError("a chessboard has no markers");
  return {};
}

int CharucoMarker(const Board& board, int column, int row) {
  if ((column + row) % 2 == 0) return -1;
  const int across = board.columns + 1;
  // Rows that begin with a dark square have across / 2 markers, the others one more if across is
  // odd.
  const int before = (row / 2) * across + (row % 2) * (across / 2);
  return before + column / 2;
}

BoardPrint::BoardPrint(const Board& board) : board_(board) {
  const double s = board.spacing;
  if (board.kind == BoardKind::kAprilTagGrid) {
    const double side = board.marker;
    extent_.extend(Eigen::Vector2d::Zero());
    extent_.extend(Eigen::Vector2d((board.columns - 1) * s + side, (board.rows - 1) * s + side));
  } else {
    extent_.extend(Eigen::Vector2d(-s, -s));
    extent_.extend(Eigen::Vector2d(board.columns * s, board.rows * s));
  }
  if (board.kind == BoardKind::kChessboard) return;
  const auto dictionary = FindMarkerDictionary(board.dictionary);
  for (int id = 0; id < MarkerCount(board); ++id) markers_.push_back(MarkerBits(**dictionary, id));
}

bool BoardPrint::MarkerDark(std::size_t marker, double x, double y) const {
  const cv::Mat& bits = markers_[marker];
  const int column = static_cast<int>(std::floor(x / board_.marker * bits.cols));
  const int row = static_cast<int>(std::floor(y / board_.marker * bits.rows));
  if (column < 0 || row < 0 || column >= bits.cols || row >= bits.rows) return false;
  return bits.at<unsigned char>(row, column) == 0;
}

bool BoardPrint::Dark(double x, double y) const {
  if (x < extent_.min().x() || y < extent_.min().y() || x >= extent_.max().x() ||
      y >= extent_.max().y())
    return false;
  const double s = board_.spacing;
  const int column = static_cast<int>(std::floor((x - extent_.min().x()) / s));
  const int row = static_cast<int>(std::floor((y - extent_.min().y()) / s));
  const double in_x = x - extent_.min().x() - column * s;
  const double in_y = y - extent_.min().y() - row * s;
  if (board_.kind == BoardKind::kAprilTagGrid) {
    const int tag = row * board_.columns + column;
    return MarkerDark(static_cast<std::size_t>(tag), in_x, in_y);
  }
  if ((column + row) % 2 == 0) return true;
  if (board_.kind == BoardKind::kChessboard) return false;
  const double margin = (s - board_.marker) / 2.0;
  return MarkerDark(static_cast<std::size_t>(CharucoMarker(board_, column, row)), in_x - margin,
                    in_y - margin);
}

}  // namespace turnlight::calib::calibrate::board
