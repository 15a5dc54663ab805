#include "calib/calibrate/board/board_words.h"

#include <charconv>

#include "base/format.h"
#include "calib/calibrate/board/board_print.h"
#include "calib/calibrate/board/marker_dictionary.h"

namespace turnlight::calib::calibrate::board {
namespace {

// A number that takes up the text's beginning; the rest stays.
std::optional<int> TakeNumber(std::string_view& text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

Status ParseSize(const std::string& size, Board& board) {
  std::string_view rest(size);
  const auto columns = TakeNumber(rest);
  bool by = false;
  for (const std::string_view sign : {"x", "X", "\xc3\x97"})  // the last one is the sign "times"
    if (!by && rest.starts_with(sign)) {
      rest.remove_prefix(sign.size());
      by = true;
    }
  const auto rows = TakeNumber(rest);
  if (!columns || !by || !rows || !rest.empty())
    return InputError("--board \"" + size +
                      "\" must be COLSxROWS, the inner corners across and down, such as 9x6");
  board.columns = *columns;
  board.rows = *rows;
  return {};
}

Status ParseMarkers(const BoardWords& words, Board& board) {
  if (!words.charuco.empty() && !words.apriltag.empty())
    return InputError("a board has --charuco or --apriltag, not both");
  const std::string option = words.charuco.empty() ? "--apriltag" : "--charuco";
  const std::string& name = words.charuco.empty() ? words.apriltag : words.charuco;
  const auto dictionary = FindMarkerDictionary(name);
  if (!dictionary) return InputError(option + ": " + dictionary.error().text);
  if (!words.marker_mm)
    return InputError(option + " needs --marker-mm, the side of a marker with its dark border");
  board.kind = words.charuco.empty() ? BoardKind::kAprilTagGrid : BoardKind::kCharuco;
  board.dictionary = name;
  board.marker = *words.marker_mm;
  return {};
}

}  // namespace

Result<Board> ParseBoard(const BoardWords& words) {
  Board board;
  if (const Status status = ParseSize(words.size, board); !status) return Forward(status);
  if (!words.square_mm)
    return InputError("--board needs --square-mm, the distance between neighbouring corners");
  board.spacing = *words.square_mm;
  if (!words.charuco.empty() || !words.apriltag.empty()) {
    if (const Status status = ParseMarkers(words, board); !status) return Forward(status);
  } else if (words.marker_mm) {
    return InputError("--marker-mm is of boards with markers: add --charuco or --apriltag");
  }
  if (const Status status = CheckBoard(board); !status)
    return InputError("--board " + words.size + ": " + status.error().text);
  return board;
}

std::string BoardText(const Board& board) {
  const std::string size = Format("%d x %d", board.columns, board.rows);
  const std::string apart = NumberText(board.spacing, 6) + " mm apart";
  if (board.kind == BoardKind::kChessboard)
    return "a chessboard of " + size + " inner corners " + apart;
  const std::string markers =
      NumberText(board.marker, 6) + " mm wide, of dictionary " + board.dictionary;
  if (board.kind == BoardKind::kCharuco)
    return "a ChArUco board of " + size + " inner corners " + apart + ", its markers " + markers;
  return "a grid of " + size + " tags " + apart + ", " + markers;
}

Result<Board> ReadBoard(StrictObject object) {
  Board read;
  const auto kind = object.OptionalChoice("kind", {"chessboard", "charuco", "apriltags"});
  if (kind == "charuco") read.kind = BoardKind::kCharuco;
  if (kind == "apriltags") read.kind = BoardKind::kAprilTagGrid;
  read.columns = static_cast<int>(object.Integer("columns", 2, 1000));
  read.rows = static_cast<int>(object.Integer("rows", 2, 1000));
  read.spacing = object.Number("spacing", {.max = 1e6, .above = 0.0});
  if (read.kind != BoardKind::kChessboard) {
    read.marker = object.Number("marker", {.max = 1e6, .above = 0.0});
    read.dictionary = object.String("dictionary");
  }
  if (const Status status = object.Finish(); !status) return Forward(status);
  if (const Status good = CheckBoard(read); !good)
    return InputError(object.Where("") + ": " + good.error().text);
  return read;
}

}  // namespace turnlight::calib::calibrate::board
