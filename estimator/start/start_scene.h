// A scene to begin a fit with.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimator/model/scene.h"
#include "estimator/observe/observations.h"

namespace turnlight::estimator::start {

// A start in the observations' coordinates with a light of equal strength in each direction: colour
// from the median, ambient from the 5 % quantile, a broad lobe, lights at 20 R.
model::Scene StartFromDirections(const observe::Observations& observations,
                                 const std::vector<Eigen::Vector3d>& directions);

}  // namespace turnlight::estimator::start
