// Proves: the share of blocks that is asked for is kept, evenly over pictures and keyframes; whole
// blocks; a smaller choice within a larger one. Does not prove that a share is enough for an
// estimate.
#include "estimator/observe/block_choice.h"

#include <gtest/gtest.h>

#include <cmath>

namespace turnlight::estimator::observe {
namespace {

constexpr int kSide = BlockChoice::kSide;

TEST(BlockChoice, KeepsItsShareEvenly) {
  const BlockChoice third{1.0 / 3.0};
  const int blocks = 60;
  for (std::uint32_t keyframe = 0; keyframe < 4; ++keyframe)
    for (const int half : {0, 1}) {
      int kept = 0;
      for (int row = 0; row < blocks; ++row)
        for (int column = half * blocks; column < (half + 1) * blocks; ++column)
          kept += third.Keeps(keyframe, column * kSide, row * kSide) ? 1 : 0;
      const double expected = blocks * blocks / 3.0;
      EXPECT_NEAR(kept, expected, 4.0 * std::sqrt(expected)) << keyframe << " " << half;
    }
}

TEST(BlockChoice, KeepsWholeBlocksAndOtherOnesInOtherKeyframes) {
  const BlockChoice half{0.5};
  int differ = 0;
  for (int row = 0; row < 8 * kSide; ++row) {
    const std::vector<bool> in_row = half.KeptInRow(3, row, 100);
    ASSERT_EQ(in_row.size(), 7u);
    for (int column = 0; column < 100; ++column) {
      const bool corner = half.Keeps(3, column / kSide * kSide, row / kSide * kSide);
      EXPECT_EQ(half.Keeps(3, column, row), corner);
      EXPECT_EQ(in_row[static_cast<std::size_t>(column / kSide)], corner);
      differ += half.Keeps(4, column, row) != corner ? 1 : 0;
    }
  }
  EXPECT_GT(differ, 0);
}

TEST(BlockChoice, FewerAreAmongThem) {
  BlockChoice choice;
  EXPECT_TRUE(choice.Keeps(0, 5, 5));
  for (int step = 0; step < 12; ++step) {
    const BlockChoice fewer = choice.Fewer();
    EXPECT_LT(fewer.share, choice.share);
    EXPECT_GT(fewer.share, 0.8 * choice.share);
    for (int block = 0; block < 200; ++block)
      if (fewer.Keeps(1, block * kSide, 0)) {
        EXPECT_TRUE(choice.Keeps(1, block * kSide, 0));
      }
    choice = fewer;
  }
}

}  // namespace
}  // namespace turnlight::estimator::observe
