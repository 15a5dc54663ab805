// Proves that a board's plane has W in the middle of its points with z towards who looks, that a
// detection becomes a view with the points' places, and that boards which look the same from
// several sides say so. Does not test detection nor poses.
#include "calib/calibrate/handheld/board_plane.h"

#include <gtest/gtest.h>

namespace turnlight::calib::calibrate::handheld {
namespace {

board::Board NineBySix() { return {board::BoardKind::kChessboard, 9, 6, 12.0, 0.0, ""}; }

TEST(BoardPlane, WIsInTheMiddleWithZTowardsWhoLooks) {
  const BoardPlane plane = PlaneOf(NineBySix());
  ASSERT_EQ(plane.places.size(), 54u);
  EXPECT_TRUE((plane.X_WB * plane.places.front()).isApprox(Eigen::Vector3d(-48.0, 30.0, 0.0)));
  EXPECT_TRUE((plane.X_WB * plane.places.back()).isApprox(Eigen::Vector3d(48.0, -30.0, 0.0)));
  // B's z points into the board.
  EXPECT_EQ(plane.X_WB.rotation.col(2), Eigen::Vector3d(0.0, 0.0, -1.0));
  EXPECT_NEAR(plane.X_WB.rotation.determinant(), 1.0, 1e-12);
}

TEST(BoardPlane, SaysFromHowManySidesTheBoardLooksTheSame) {
  EXPECT_TRUE(PlaneOf(NineBySix()).options.same_looking.empty());
  board::Board square = NineBySix();
  square.columns = square.rows = 10;
  EXPECT_EQ(PlaneOf(square).options.same_looking.size(), 3u);
}

TEST(BoardPlane, ADetectionBecomesAView) {
  const BoardPlane plane = PlaneOf(NineBySix());
  board::Detection detection;
  EXPECT_EQ(ViewOf("a.png", detection, plane).why_none, "no board in it");
  detection.remarks = {"too dark"};
  EXPECT_EQ(ViewOf("a.png", detection, plane).why_none, "too dark");
  detection.boards.emplace_back();
  detection.boards[0].view.points = {{10, {3.0, 4.0}, 2.0}};
  const PlaneView view = ViewOf("a.png", detection, plane);
  EXPECT_EQ(view.name, "a.png");
  ASSERT_EQ(view.points.size(), 1u);
  EXPECT_EQ(view.points[0].p_B, Eigen::Vector2d(12.0, 12.0));
  EXPECT_EQ(view.points[0].pixel, Eigen::Vector2d(3.0, 4.0));
  EXPECT_EQ(view.points[0].spread, 2.0);
}

}  // namespace
}  // namespace turnlight::calib::calibrate::handheld
