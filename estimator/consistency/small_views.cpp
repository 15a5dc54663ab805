#include "estimator/consistency/small_views.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/parallel.h"
#include "base/statistics.h"

namespace turnlight::estimator::consistency {
namespace {

constexpr double kTargetPixels = 2500.0;
constexpr int kLeastRows = 60;

// How many pixels a sphere around the target covers; 0 if it is not in front of the camera.
double CoveredPixels(const calib::CameraModel& camera, const target::Geometry& geometry,
                     const calib::RigPoses& poses) {
  const Eigen::Vector3d center = poses.X_WC.Inverse() * (poses.X_WT * geometry.center());
  const auto points = camera.Project({center, center + Eigen::Vector3d(geometry.radius(), 0.0, 0.0),
                                      center + Eigen::Vector3d(0.0, geometry.radius(), 0.0)});
  const double across = (points[1] - points[0]).norm(), down = (points[2] - points[0]).norm();
  const double area = std::numbers::pi * across * down;
  if (!(area > 0.0) || center.z() <= geometry.radius()) return 0.0;
  return std::min(area, static_cast<double>(camera.width()) * camera.height());
}

}  // namespace

int BlockFor(const calib::CameraModel& camera, const target::Geometry& geometry,
             const std::vector<calib::RigPoses>& poses) {
  std::vector<double> areas;
  for (const calib::RigPoses& pose : poses)
    if (const double area = CoveredPixels(camera, geometry, pose); area > 0.0)
      areas.push_back(area);
  const double area = areas.empty() ? 0.1 * camera.width() * camera.height() : Median(areas);
  const int wanted = static_cast<int>(std::sqrt(area / kTargetPixels));
  return std::clamp(wanted, 1, std::max(1, std::min(camera.width(), camera.height()) / kLeastRows));
}

SmallView MakeSmallView(const model::Keyframe& keyframe, int block, std::size_t number) {
  const cv::Mat& image = keyframe.image.radiance;
  const int rows = image.rows / block, columns = image.cols / block, channels = image.channels();
  SmallView out{cv::Mat1f(rows, columns),
                cv::Mat1b(rows, columns),
                cv::Mat1b(rows, columns),
                {keyframe.X_WC, keyframe.X_WT},
                number};
  ParallelFor(static_cast<std::size_t>(rows), [&](std::size_t r) {
    const int row = static_cast<int>(r);
    for (int column = 0; column < columns; ++column) {
      double sum = 0.0;
      bool clipped = false, inside = true;
      for (int y = row * block; y < (row + 1) * block; ++y)
        for (int x = column * block; x < (column + 1) * block; ++x) {
          clipped = clipped || keyframe.image.saturated(y, x) != 0;
          inside = inside && keyframe.mask(y, x) != 0;
          const float* value = image.ptr<float>(y) + static_cast<std::ptrdiff_t>(x) * channels;
          for (int c = 0; c < channels; ++c) sum += static_cast<double>(value[c]);
        }
      const bool finite = std::isfinite(sum);
      out.radiance(row, column) =
          finite ? static_cast<float>(sum / (block * block * channels)) : 0.0f;
      out.clipped(row, column) = clipped || !finite ? 255 : 0;
      out.mask(row, column) = inside ? 255 : 0;
    }
  });
  return out;
}

cv::Mat1f Masked(const SmallView& view) {
  if (view.mask.empty()) return view.radiance;
  cv::Mat1f out = cv::Mat1f::zeros(view.radiance.size());
  view.radiance.copyTo(out, view.mask);
  return out;
}

std::vector<calib::RigPoses> PosesOf(const SmallViews& views) {
  std::vector<calib::RigPoses> out;
  for (const SmallView& view : views.views) out.push_back(view.poses);
  return out;
}

std::vector<std::size_t> InOrder(const SmallViews& views) {
  std::vector<std::size_t> out(views.views.size());
  std::iota(out.begin(), out.end(), std::size_t{0});
  return out;
}

std::vector<model::Keyframe> ToKeyframes(const SmallViews& views,
                                         const std::vector<calib::RigPoses>& poses,
                                         const std::vector<std::size_t>& picture) {
  std::vector<model::Keyframe> out;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const SmallView& view = views.views[picture[k]];
    out.push_back({{view.radiance, view.clipped, {}}, view.mask, poses[k].X_WC, poses[k].X_WT});
  }
  return out;
}

std::vector<model::Keyframe> ToKeyframes(const SmallViews& views) {
  return ToKeyframes(views, PosesOf(views), InOrder(views));
}

}  // namespace turnlight::estimator::consistency
