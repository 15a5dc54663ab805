// Which pixels are kept when there are more than an estimate may hold: whole blocks, since shadows'
// edges and noise are looked for between neighbours.
#pragma once

#include <cstdint>
#include <vector>

namespace turnlight::estimator::observe {

// Blocks are kept evenly over keyframes and pictures, by a fixed number of each: those of a smaller
// share are among those of a larger one.
struct BlockChoice {
  static constexpr int kSide = 16;  // pixels

  double share = 1.0;  // of the blocks that are kept, (0, 1]

  // The block of a pixel of that keyframe. column and row are at least 0.
  bool Keeps(std::uint32_t keyframe, int column, int row) const;
  // By block column, of the blocks that a row of a picture runs through.
  std::vector<bool> KeptInRow(std::uint32_t keyframe, int row, int width) const;
  // A step fewer.
  BlockChoice Fewer() const;
};

}  // namespace turnlight::estimator::observe
