#include "estimator/observe/usable.h"

#include <algorithm>
#include <string>
#include <utility>

#include "base/format.h"
#include "base/messages/messages.h"
#include "base/statistics.h"
#include "estimator/observe/keyframe_tracer.h"
#include "estimator/observe/radiance_statistics.h"

namespace turnlight::estimator::observe {
namespace {

constexpr std::size_t kMinPixels = 30;
constexpr double kManyOutliers = 0.005, kMostOutliers = 0.35;  // of the target's pixels

// Bright pixels at this share of white leave no room for more light.
constexpr double kNearWhite = 0.3;
// Values of one clipped level: 8 bits and a JPEG's ringing keep within it.
constexpr float kSameLevel = 0.97f;

// The row of the table of messages that says why so few pixels are usable, and the pixels of it.
std::pair<std::string, std::size_t> WhyUnusable(const FlagCounts& counts) {
  const auto most = [&](std::size_t count) { return 2 * count > counts.on_target; };
  if (counts.from_behind > 0.5) return {"seen-from-behind", 0};
  if (counts.on_target == 0) return {counts.in_masks == 0 ? "empty-masks" : "no-target-in-view", 0};
  if (most(counts.not_numbers)) return {"not-numbers", counts.not_numbers};
  if (most(counts.saturated))
    return {2 * counts.above > counts.saturated ? "clipped-by-setting" : "clipped",
            counts.saturated};
  if (most(counts.lost))
    return {counts.bright < kNearWhite ? "too-dark" : "too-noisy", counts.lost};
  if (most(counts.edge))
    return {2 * counts.oblique > counts.edge ? "too-oblique" : "too-small", counts.edge};
  return {"too-few", 0};
}

tl::unexpected<Error> TooFew(std::size_t used, const FlagCounts* counts) {
  messages::Values values{{"used", std::to_string(used)}, {"least", std::to_string(kMinPixels)}};
  if (counts == nullptr) return messages::Refuse("too-few/so-far", values);
  const auto [id, count] = WhyUnusable(*counts);
  values["count"] = std::to_string(count);
  values["on_target"] = std::to_string(counts->on_target);
  values["bright"] = Format("%.2g", counts->bright);
  values["share"] = Format("%.0f", 100.0 * counts->from_behind);
  values["saturated"] = std::to_string(counts->saturated);
  values["lost"] = std::to_string(counts->lost);
  values["edge"] = std::to_string(counts->edge);
  values["outliers"] = std::to_string(counts->outliers);
  return messages::Refuse(id, values);
}

float LargestValue(const cv::Mat& image, int row, int column) {
  const float* value =
      image.ptr<float>(row) + static_cast<std::ptrdiff_t>(column) * image.channels();
  return *std::max_element(value, value + image.channels());
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
      counts.oblique += (flag & (kSilhouette | kGrazing)) == kGrazing ? 1 : 0;
    }
  return counts;
}

void CountValues(const model::Keyframe& keyframe, const cv::Mat1b& flags, FlagCounts& counts) {
  // A quantile needs no more than so many of them.
  constexpr std::size_t kSampled = 100'000;
  const std::size_t step = std::max<std::size_t>(1, flags.total() / kSampled);
  std::vector<float> values, clipped;
  std::size_t seen = 0;
  for (int row = 0; row < flags.rows; ++row)
    for (int column = 0; column < flags.cols; ++column) {
      counts.in_masks += keyframe.mask(row, column) != 0 ? 1 : 0;
      if (flags(row, column) & kOffTarget) continue;
      const float value = LargestValue(keyframe.image.radiance, row, column);
      if (seen++ % step == 0) values.push_back(value);
      if (keyframe.image.saturated(row, column) == 0) continue;
      // What is no number was made 0 and flagged (calib::Linearise).
      if (value == 0.0f)
        ++counts.not_numbers;
      else
        clipped.push_back(value);
    }
  if (values.empty()) return;
  counts.bright = std::max(counts.bright, static_cast<double>(LowerQuantile(values, 0.99)));
  if (clipped.empty()) return;
  const float level = kSameLevel * *std::max_element(clipped.begin(), clipped.end());
  counts.above += static_cast<std::size_t>(std::count_if(
      clipped.begin(), clipped.end(), [level](float value) { return value < level; }));
}

double ShareFromBehind(const model::Keyframe& keyframe, const target::Geometry& geometry,
                       const calib::RayGrid& rays) {
  constexpr std::size_t kRays = 10'000;
  const calib::Pose X_TC = keyframe.X_WT.Inverse() * keyframe.X_WC;
  const std::size_t pixels = keyframe.mask.total(), step = std::max<std::size_t>(1, pixels / kRays);
  std::size_t met = 0, behind = 0;
  for (std::size_t i = 0; i < pixels; i += step) {
    const int row = static_cast<int>(i) / rays.width(), column = static_cast<int>(i) % rays.width();
    const Eigen::Vector3d ray = rays.Ray(column, row, 0.0, 0.0);
    if (keyframe.mask(row, column) == 0 || !ray.allFinite()) continue;
    const Eigen::Vector3d direction = X_TC.rotation * ray;
    const auto point = geometry.Intersect(X_TC.translation, direction);
    const bool back =
        point ? std::max(point->normal.dot(direction), point->geometric_normal.dot(direction)) > 0.0
              : geometry.SeesBack(X_TC.translation, direction);
    met += point || back ? 1 : 0;
    behind += back ? 1 : 0;
  }
  return met > 0 ? static_cast<double>(behind) / static_cast<double>(met) : 0.0;
}

Status CheckUsable(const Observations& all, const FlagCounts* counts) {
  if (all.used < kMinPixels) return TooFew(all.used, counts);
  const double brightest = BrightestRadiance(all) * all.radiance_unit;
  if (brightest <= kDarkRadiance)
    return messages::Refuse("black", {{"bright", Format("%.2g", brightest)}});
  return {};
}

Status CheckOutliers(const FlagCounts& counts) {
  if (static_cast<double>(counts.outliers) <= kMostOutliers * static_cast<double>(counts.on_target))
    return {};
  return messages::Refuse("not-a-surface", {{"count", std::to_string(counts.outliers)},
                                            {"on_target", std::to_string(counts.on_target)}});
}

bool ManyOutliers(const FlagCounts& counts) {
  return static_cast<double>(counts.outliers) >
         kManyOutliers * static_cast<double>(counts.on_target);
}

}  // namespace turnlight::estimator::observe
