#include "estimator/observe/usable.h"

#include "base/format.h"
#include "estimator/observe/keyframe_tracer.h"
#include "estimator/observe/radiance_statistics.h"

namespace turnlight::estimator::observe {
namespace {

constexpr std::size_t kMinPixels = 30;
constexpr double kManyOutliers = 0.005, kMostOutliers = 0.35;  // of the target's pixels
constexpr double kDarkRadiance = 1e-7;                         // white is 1: nothing was lit

// Why so few pixels are usable.
std::string WhyUnusable(const FlagCounts& counts) {
  if (2 * counts.from_behind > counts.rays)
    return Format(
        "%zu of %zu rays that meet the mesh meet its faces from behind: its winding is "
        "inside out, or an open surface is seen from its back. Turn the faces round, so "
        "that they are counter-clockwise seen from outside.",
        counts.from_behind, counts.rays);
  if (counts.on_target == 0)
    return "No pixel shows the target: check the poses, the masks and the target's size.";
  const auto of = [&](std::size_t count) {
    return Format("%zu of %zu target pixels ", count, counts.on_target);
  };
  if (2 * counts.saturated > counts.on_target)
    return of(counts.saturated) + "are clipped: lower the exposure or the gain.";
  if (2 * counts.lost > counts.on_target)
    return of(counts.lost) +
           "are lost in noise: expose longer, lower the gain, or average pictures.";
  return of(counts.edge) + "are at the outline or too oblique: move the camera closer.";
}

}  // namespace

FlagCounts CountFlags(const std::vector<cv::Mat1b>& flags, FlagCounts counts) {
  for (const cv::Mat1b& picture : flags)
    for (const std::uint8_t flag : picture) {
      if (flag & kOffTarget) continue;
      ++counts.on_target;
      counts.saturated += (flag & kSaturated) != 0 ? 1 : 0;
      counts.outliers += (flag & kUnlikeOthers) != 0 ? 1 : 0;
      counts.lost += (flag & kLostInNoise) != 0 ? 1 : 0;
      counts.edge += (flag & (kSilhouette | kGrazing)) != 0 ? 1 : 0;
    }
  return counts;
}

Status CheckUsable(const Observations& all, const FlagCounts* counts) {
  if (all.used < kMinPixels)
    return NoEstimateError("no usable estimate: " + std::to_string(all.used) +
                           " usable pixels, at least " + std::to_string(kMinPixels) +
                           " are needed. " + (counts != nullptr ? WhyUnusable(*counts) : ""));
  if (const double brightest = BrightestRadiance(all); brightest <= kDarkRadiance)
    return NoEstimateError("no usable estimate: every usable pixel is black (99.9 % at or below " +
                           std::to_string(brightest) +
                           " of white): check the lamp, the exposure and radiometry.black.");
  return {};
}

Status CheckOutliers(const FlagCounts& counts) {
  if (static_cast<double>(counts.outliers) <= kMostOutliers * static_cast<double>(counts.on_target))
    return {};
  return NoEstimateError(
      Format("no usable estimate: %zu of %zu target pixels are unlike all around them: the "
             "pictures show something else than a surface; check their format and the masks.",
             counts.outliers, counts.on_target));
}

bool ManyOutliers(const FlagCounts& counts) {
  return static_cast<double>(counts.outliers) >
         kManyOutliers * static_cast<double>(counts.on_target);
}

}  // namespace turnlight::estimator::observe
