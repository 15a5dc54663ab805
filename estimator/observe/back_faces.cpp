#include "estimator/observe/back_faces.h"

#include <algorithm>

namespace turnlight::estimator::observe {

void CountBackFaces(const model::Keyframe& keyframe, const target::Geometry& geometry,
                    const calib::RayGrid& rays, FlagCounts& counts) {
  constexpr int kSamples = 64;  // along the shorter side of the picture
  const int step = std::max(1, std::min(rays.width(), rays.height()) / kSamples);
  const calib::Pose X_TC = keyframe.X_WT.Inverse() * keyframe.X_WC;
  for (int row = step / 2; row < rays.height(); row += step)
    for (int column = step / 2; column < rays.width(); column += step) {
      const Eigen::Vector3d ray = rays.Ray(column, row);
      if (keyframe.mask(row, column) == 0 || !ray.allFinite()) continue;
      const Eigen::Vector3d direction = X_TC.rotation * ray;
      const bool behind = geometry.MeetsBack(X_TC.translation, direction);
      counts.from_behind += behind ? 1 : 0;
      counts.rays += behind || geometry.Intersect(X_TC.translation, direction) ? 1 : 0;
    }
}

}  // namespace turnlight::estimator::observe
