// Proves: a known homography comes back, and what does not determine one gives none.
#include "calib/calibrate/board/homography.h"

#include <gtest/gtest.h>

namespace turnlight::calib::calibrate::board {
namespace {

TEST(FitHomography, ComesBackFromItsOwnPoints) {
  Eigen::Matrix3d truth;
  truth << 120, 15, 400, -8, 140, 300, 0.02, -0.03, 1;
  std::vector<Eigen::Vector2d> from, to;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 5; ++column) {
      from.emplace_back(column, row);
      to.push_back(Map(truth, from.back()));
    }
  const auto fitted = FitHomography(from, to);
  ASSERT_TRUE(fitted);
  for (std::size_t i = 0; i < from.size(); ++i)
    EXPECT_LT((Map(*fitted, from[i]) - to[i]).norm(), 1e-6);
}

TEST(FitHomography, NothingFromALineOrTooFewPoints) {
  std::vector<Eigen::Vector2d> line;
  for (int i = 0; i < 6; ++i) line.emplace_back(i, 2.0 * i);
  EXPECT_FALSE(FitHomography(line, line));
  EXPECT_FALSE(FitHomography({{0, 0}, {1, 0}, {0, 1}}, {{0, 0}, {1, 0}, {0, 1}}));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::board
