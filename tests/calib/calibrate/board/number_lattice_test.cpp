// Proves: which numberings of a board look the same, counted by hand, and that point 0 is canonical
// where colours tell it.
#include "calib/calibrate/board/number_lattice.h"

#include <gmock/gmock.h>

#include <set>

#include "calib/calibrate/board/board_print.h"
#include "tests/calib/calibrate/board/rendered_board.h"

namespace turnlight::calib::calibrate::board {
namespace {

TEST(SameLookingNumberings, AsManyAsTheSquaresColoursAllow) {
  EXPECT_EQ(SameLookingNumberings(Chessboard(10, 10)).size(), 4u);
  EXPECT_EQ(SameLookingNumberings(Chessboard(7, 7)).size(), 2u);
  EXPECT_EQ(SameLookingNumberings(Chessboard(8, 6)).size(), 2u);
  EXPECT_EQ(SameLookingNumberings(Chessboard(9, 7)).size(), 2u);
  EXPECT_EQ(SameLookingNumberings(Chessboard(9, 6)).size(), 1u);
  EXPECT_EQ(SameLookingNumberings({BoardKind::kAprilTagGrid, 4, 4, 30.0, 20.0, "tag36h11"}).size(),
            1u);
}

// Every point and every colour goes where the numbering says: a turn of the plane.
TEST(SameLookingNumberings, AreTurnsThatKeepThePrint) {
  for (const Board& board : {Chessboard(10, 10), Chessboard(7, 7), Chessboard(8, 6)}) {
    const BoardPrint print(board);
    const auto points = BoardPoints(board);
    for (const auto& way : SameLookingNumberings(board)) {
      EXPECT_EQ(std::set<std::size_t>(way.begin(), way.end()).size(), board.PointCount());
      for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const double before = (points[i + 1] - points[i]).norm();
        EXPECT_DOUBLE_EQ((points[way[i + 1]] - points[way[i]]).norm(), before);
      }
      const Eigen::Vector2d along = (points[way[1]] - points[way[0]]).head<2>();
      const Eigen::Vector2d down =
          (points[way[static_cast<std::size_t>(board.columns)]] - points[way[0]]).head<2>();
      EXPECT_GT(along.x() * down.y() - along.y() * down.x(), 0.0);
      const Eigen::Vector2d before_first = points[way[0]].head<2>() - (along + down) / 2.0;
      EXPECT_TRUE(print.Dark(before_first.x(), before_first.y()));
    }
  }
}

TEST(NumberLattice, PointZeroOfA9x6BoardIsTheSameInEveryView) {
  const auto camera = TestCamera();
  for (const double roll : {0.0, 90.0, 180.0, 270.0}) {
    const auto placed = Place(Chessboard(9, 6), {20.0, 30.0, roll, 450.0});
    const auto found = DetectBoards(rig::sim::RenderBoards({placed}, camera), placed.board);
    ASSERT_TRUE(found && found->boards.size() == 1u);
    const auto truth = rig::sim::BoardPixels(placed, camera);
    EXPECT_LT((found->boards[0].view.points[0].pixel - truth[0]).norm(), 0.2) << roll;
  }
}

}  // namespace
}  // namespace turnlight::calib::calibrate::board
