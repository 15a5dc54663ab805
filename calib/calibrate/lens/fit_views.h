// The fit of a lens model to views, and which views do not belong to it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/calibrate/board/board.h"
#include "calib/calibrate/lens/calibrate_lens.h"
#include "calib/calibrate/lens/problem.h"

namespace turnlight::calib::calibrate::lens {

struct FitDrop {
  std::size_t view = 0;  // of those given
  std::string reason;
};

struct ViewsFit {
  Problem problem;                // at its optimum
  Pass pass;                      // of its last step
  std::vector<std::size_t> used;  // which views the problem's poses are of
  std::vector<FitDrop> dropped;
};

// At least two views with four points each. Fails (kNoEstimate) if the optimizer finds no fit.
Result<ViewsFit> FitViews(const std::array<int, 2>& image_size, const board::Board& board,
                          const std::vector<board::BoardView>& views, const LensOptions& options);

}  // namespace turnlight::calib::calibrate::lens
