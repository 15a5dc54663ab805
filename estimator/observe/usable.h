// Whether what was observed is enough for an estimate, and why not.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "base/result.h"
#include "estimator/observe/observations.h"

namespace turnlight::estimator::observe {

// Pixels of the target by what was found about them, over all keyframes.
struct FlagCounts {
  std::size_t on_target = 0, saturated = 0, outliers = 0, lost = 0, edge = 0;
  std::size_t rays = 0, from_behind = 0;  // of a sample: that meet the target, and its back
};
// Added to counts.
FlagCounts CountFlags(const std::vector<cv::Mat1b>& flags, FlagCounts counts = {});

// Fails with kNoEstimate if fewer than 30 pixels are usable, or all of them are black. With counts
// (optional) the text says why the others are not, and what to do.
Status CheckUsable(const Observations& observations, const FlagCounts* counts = nullptr);

// Fails with kNoEstimate if more than 35 % of the target's pixels are outliers.
Status CheckOutliers(const FlagCounts& counts);
// Whether there are so many (0.5 %) that some may have been missed.
bool ManyOutliers(const FlagCounts& counts);

}  // namespace turnlight::estimator::observe
