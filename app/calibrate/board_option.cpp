#include "app/calibrate/board_option.h"

#include <charconv>

#include "calib/calibrate/board/board_print.h"

namespace turnlight::app {
namespace {

using calib::calibrate::board::Board;
using calib::calibrate::board::BoardKind;

bool ReadCount(const char* begin, const char* end, int& count) {
  const auto read = std::from_chars(begin, end, count);
  return read.ec == std::errc() && read.ptr == end && begin != end;
}

}  // namespace

void AddBoardOptions(CLI::App& command, BoardArguments& arguments) {
  command
      .add_option("--board", arguments.size,
                  "The board: inner corners across and down; of --markers apriltag, tags across "
                  "and down")
      ->type_name("COLSxROWS")
      ->required();
  command
      .add_option("--square-mm", arguments.square_mm,
                  "Between neighbouring corners, or tags' left edges, as measured on the print")
      ->type_name("MM")
      ->required()
      ->check(CLI::Range(1e-3, 1e5));
  command
      .add_option(
          "--markers", arguments.markers,
          "none (default): a chessboard; charuco: one with markers; apriltag: a grid of tags")
      ->type_name("NAME")
      ->check(CLI::IsMember({"none", "charuco", "apriltag"}));
  command
      .add_option("--marker-mm", arguments.marker_mm,
                  "Side of a marker or tag, with its black edge")
      ->type_name("MM")
      ->check(CLI::Range(1e-3, 1e5));
  command
      .add_option("--dictionary", arguments.dictionary,
                  "Of the markers, as OpenCV names it: 4X4_50, 5X5_100, APRILTAG_36h11")
      ->type_name("NAME");
}

Result<Board> BoardOf(const BoardArguments& arguments) {
  Board board;
  const std::string& size = arguments.size;
  const std::size_t cross = size.find_first_of("xX");
  const char* const begin = size.data();
  const char* const end = begin + size.size();
  if (cross == std::string::npos || !ReadCount(begin, begin + cross, board.columns) ||
      !ReadCount(begin + cross + 1, end, board.rows))
    return InputError("--board: \"" + size +
                      "\", allowed are two whole numbers, inner corners across and down: 10x10");
  board.kind = arguments.markers == "charuco"    ? BoardKind::kCharuco
               : arguments.markers == "apriltag" ? BoardKind::kAprilTagGrid
                                                 : BoardKind::kChessboard;
  board.spacing = arguments.square_mm;
  board.marker = arguments.marker_mm;
  board.dictionary = arguments.dictionary;
  if (board.kind == BoardKind::kAprilTagGrid && board.dictionary.empty())
    board.dictionary = "APRILTAG_36h11";
  if (const Status status = calib::calibrate::board::CheckBoard(board); !status)
    return InputError("--board: " + status.error().text);
  return board;
}

}  // namespace turnlight::app
