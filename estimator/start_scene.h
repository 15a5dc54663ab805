// A scene to begin a fit with.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimator/observations.h"
#include "estimator/scene.h"

namespace turnlight::estimator {

// A start in the observations' coordinates with a light of equal strength in each direction: colour
// from the median, ambient from the 5 % quantile, a broad lobe, lights at 20 R.
Scene StartFromDirections(const Observations& observations,
                          const std::vector<Eigen::Vector3d>& directions);

}  // namespace turnlight::estimator
