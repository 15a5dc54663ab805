// Proves: the print's colours by hand-counted squares, and that boards which cannot be are refused
// in words. Does not prove that markers have the right bits: detect_boards_test.cpp reads them
// back.
#include "calib/calibrate/board/board_print.h"

#include <gmock/gmock.h>

namespace turnlight::calib::calibrate::board {
namespace {

using testing::HasSubstr;

TEST(BoardPrint, AChessboardBeginsDark) {
  const BoardPrint print({BoardKind::kChessboard, 4, 3, 10.0, 0.0, ""});
  EXPECT_TRUE(print.Dark(-5, -5));
  EXPECT_FALSE(print.Dark(5, -5));
  EXPECT_TRUE(print.Dark(5, 5));
  EXPECT_FALSE(print.Dark(-10.1, -5));
  EXPECT_FALSE(print.Dark(40.1, 5));
  EXPECT_EQ(print.extent().max(), Eigen::Vector2d(40, 30));
}

TEST(BoardPrint, CharucoMarkersFillTheBrightSquaresRowByRow) {
  const Board board{BoardKind::kCharuco, 4, 3, 10.0, 6.0, "4X4_50"};  // 5 x 4 squares
  EXPECT_EQ(CharucoMarker(board, 0, 0), -1);
  EXPECT_EQ(CharucoMarker(board, 1, 0), 0);
  EXPECT_EQ(CharucoMarker(board, 3, 0), 1);
  EXPECT_EQ(CharucoMarker(board, 0, 1), 2);
  EXPECT_EQ(CharucoMarker(board, 4, 1), 4);
  EXPECT_EQ(CharucoMarker(board, 1, 2), 5);
  const BoardPrint print(board);
  EXPECT_FALSE(print.Dark(1, -9));     // the rim of square (1, 0)
  EXPECT_TRUE(print.Dark(2.5, -7.5));  // its marker's border
}

TEST(BoardPrint, ATagGridsGapsAreBright) {
  const BoardPrint print({BoardKind::kAprilTagGrid, 2, 2, 30.0, 20.0, "tag36h11"});
  EXPECT_TRUE(print.Dark(1, 1));
  EXPECT_FALSE(print.Dark(25, 5));
  EXPECT_TRUE(print.Dark(31, 31));
}

TEST(BoardPrint, RefusesWhatCannotBe) {
  const auto text = [](const Board& board) {
    const Status status = CheckBoard(board);
    return status ? std::string() : status.error().text;
  };
  EXPECT_EQ(text({BoardKind::kChessboard, 9, 6, 10.0, 0.0, ""}), "");
  EXPECT_THAT(text({BoardKind::kChessboard, 1, 6, 10.0, 0.0, ""}), HasSubstr("1 x 6"));
  EXPECT_THAT(text({BoardKind::kChessboard, 9, 6, -1.0, 0.0, ""}), HasSubstr("-1"));
  EXPECT_THAT(text({BoardKind::kChessboard, 9, 6, 0.0 / 0.0, 0.0, ""}), HasSubstr("nan"));
  EXPECT_THAT(text({BoardKind::kCharuco, 9, 6, 10.0, 10.0, "4X4_50"}), HasSubstr("below"));
  EXPECT_THAT(text({BoardKind::kCharuco, 9, 6, 10.0, 7.0, "4X4"}), HasSubstr("4X4_1000"));
  EXPECT_THAT(text({BoardKind::kCharuco, 19, 9, 10.0, 7.0, "4X4_50"}), HasSubstr("100 markers"));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::board
