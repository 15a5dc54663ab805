// Proves: where the points of each kind of board are, in the order of their numbers.
#include "calib/calibrate/board/board.h"

#include <gtest/gtest.h>

namespace turnlight::calib::calibrate::board {
namespace {

TEST(Board, AChessboardsPointsGoRowByRow) {
  const Board board{BoardKind::kChessboard, 3, 2, 5.0, 0.0, ""};
  const auto points = BoardPoints(board);
  ASSERT_EQ(points.size(), board.PointCount());
  EXPECT_EQ(points[0], Eigen::Vector3d(0.0, 0.0, 0.0));
  EXPECT_EQ(points[2], Eigen::Vector3d(10.0, 0.0, 0.0));
  EXPECT_EQ(points[5], Eigen::Vector3d(10.0, 5.0, 0.0));
}

TEST(Board, ATagsCornersGoClockwiseFromTheTopLeft) {
  const Board board{BoardKind::kAprilTagGrid, 2, 2, 30.0, 20.0, "APRILTAG_36h11"};
  const auto points = BoardPoints(board);
  ASSERT_EQ(points.size(), 16u);
  EXPECT_EQ(points[4], Eigen::Vector3d(30.0, 0.0, 0.0));
  EXPECT_EQ(points[5], Eigen::Vector3d(50.0, 0.0, 0.0));
  EXPECT_EQ(points[10], Eigen::Vector3d(20.0, 50.0, 0.0));
  EXPECT_EQ(points[15], Eigen::Vector3d(30.0, 50.0, 0.0));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::board
