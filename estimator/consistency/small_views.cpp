#include "estimator/consistency/small_views.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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
  for (int row = 0; row < rows; ++row)
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
      clipped = clipped || !std::isfinite(sum);
      out.radiance(row, column) = clipped && !std::isfinite(sum)
                                      ? 0.0f
                                      : static_cast<float>(sum / (block * block * channels));
      out.clipped(row, column) = clipped ? 255 : 0;
      out.mask(row, column) = inside ? 255 : 0;
    }
  return out;
}

model::Keyframe ToKeyframe(const SmallView& view, const calib::RigPoses& poses) {
  return {{view.radiance, view.clipped, {}}, view.mask, poses.X_WC, poses.X_WT};
}

}  // namespace turnlight::estimator::consistency
