// Whether what was observed is enough for an estimate, and why not.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "base/result.h"
#include "calib/camera_model.h"
#include "estimator/model/keyframe.h"
#include "estimator/observe/observations.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::observe {

// Pixels of the target by what was found about them, over all keyframes.
struct FlagCounts {
  std::size_t on_target = 0, saturated = 0, outliers = 0, lost = 0, edge = 0;
  std::size_t oblique = 0;  // of edge: seen too flat, away from any outline
  // By CountValues:
  std::size_t in_masks = 0;     // pixels that the masks let through, on the target or not
  std::size_t not_numbers = 0;  // NaN or infinite
  std::size_t above = 0;        // above the saturation, at a value that is not the largest
  // By ShareFromBehind: of the rays that meet the target, those that meet it from behind.
  double from_behind = 0.0;
  double bright = 0.0;  // radiance that a hundredth of a picture's target exceeds; of the
                        // brightest picture
};
// Added to counts.
FlagCounts CountFlags(const std::vector<cv::Mat1b>& flags, FlagCounts counts = {});
// Adds what a keyframe's values say of its target's pixels.
void CountValues(const model::Keyframe& keyframe, const cv::Mat1b& flags, FlagCounts& counts);

// Of a keyframe's rays through the mask that meet the target, the share that meets a face from
// behind, or where the normal points away; of a sample of them.
double ShareFromBehind(const model::Keyframe& keyframe, const target::Geometry& geometry,
                       const calib::RayGrid& rays);

// Fails with kNoEstimate if fewer than 30 pixels are usable, or all of them are black. With counts
// (optional) the text says why the others are not, and what to do.
Status CheckUsable(const Observations& observations, const FlagCounts* counts = nullptr);

// Fails with kNoEstimate if more than 35 % of the target's pixels are outliers.
Status CheckOutliers(const FlagCounts& counts);
// Whether there are so many (0.5 %) that some may have been missed.
bool ManyOutliers(const FlagCounts& counts);

}  // namespace turnlight::estimator::observe
