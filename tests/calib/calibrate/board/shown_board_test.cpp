// Proves: a wrong size of board is told from what all pictures show, whether a whole board of
// another size is in them or never more than a part, and a right one passes though some pictures
// show another. Does not prove that detection tells a size (detect_boards_test.cpp).
#include "calib/calibrate/board/shown_board.h"

#include <gmock/gmock.h>

#include "tests/calib/calibrate/board/rendered_board.h"

namespace turnlight::calib::calibrate::board {
namespace {

using testing::HasSubstr;

// The first columns and rows of the board.
Detection PartOf(const Board& board, int columns, int rows) {
  Detection detection;
  detection.boards.emplace_back();
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      detection.boards[0].view.points.push_back(
          {static_cast<std::size_t>(row * board.columns + column), {10.0 * column, 10.0 * row}});
  return detection;
}

Detection Other(int columns, int rows) {
  Detection detection;
  detection.others.push_back({columns, rows});
  return detection;
}

std::string Refusal(const std::vector<Result<Detection>>& found, const Board& board) {
  const std::vector<std::string> names(found.size(), "a.png");
  const Status status = CheckShownBoard(names, found, board);
  return status ? std::string() : status.error().text;
}

TEST(ShownBoard, AnotherSizeInHardlyAllPicturesIsRefused) {
  const Board board = Chessboard(9, 6);
  std::vector<Result<Detection>> found(9, Other(7, 7));
  found.emplace_back(PartOf(board, 5, 4));
  found.emplace_back(InputError("no such file"));
  EXPECT_THAT(Refusal(found, board),
              testing::AllOf(HasSubstr("--board 9x6: 9 of the 11 pictures show a board of 7 x 7 "
                                       "inner corners instead (a.png, ...)"),
                             HasSubstr("is it --board 7x7?")));
  found.assign(4, Other(7, 7));
  found.emplace_back(PartOf(board, 9, 6));
  EXPECT_EQ(Refusal(found, board), "");
  EXPECT_EQ(Refusal(found, {BoardKind::kAprilTagGrid, 9, 6, 30.0, 20.0, "tag36h11"}), "");
}

TEST(ShownBoard, ABoardOfWhichNobodyEverSeesMoreThanAPartIsRefused) {
  const Board board = Chessboard(8, 8);
  std::vector<Result<Detection>> found(6, PartOf(board, 7, 7));
  EXPECT_THAT(Refusal(found, board), HasSubstr("shows more than 7 x 7 inner corners, and 6 show"));
  found.emplace_back(PartOf(board, 8, 5));
  found.emplace_back(PartOf(board, 5, 8));
  EXPECT_EQ(Refusal(found, board), "");
}

}  // namespace
}  // namespace turnlight::calib::calibrate::board
