#include "estimator/observe/block_choice.h"

#include "base/random.h"

namespace turnlight::estimator::observe {
namespace {

constexpr std::uint64_t kSeed = 7;
// About the fourth root of a half: what is kept is never much less than what is allowed.
constexpr double kStep = 0.84;

}  // namespace

bool BlockChoice::Keeps(std::uint32_t keyframe, int column, int row) const {
  if (share >= 1.0) return true;
  const auto block_row = static_cast<std::uint64_t>(row / kSide);
  const auto block_column = static_cast<std::uint64_t>(column / kSide);
  return RandomStream(kSeed, keyframe).Uniform(block_row << 32 | block_column) < share;
}

std::vector<bool> BlockChoice::KeptInRow(std::uint32_t keyframe, int row, int width) const {
  std::vector<bool> kept;
  for (int column = 0; column < width; column += kSide)
    kept.push_back(Keeps(keyframe, column, row));
  return kept;
}

BlockChoice BlockChoice::Fewer() const { return {kStep * share}; }

}  // namespace turnlight::estimator::observe
