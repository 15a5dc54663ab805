// Directions spread evenly.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace turnlight::estimator::model {

// K directions spread evenly over the hemisphere around `up` (a Fibonacci lattice).
std::vector<Eigen::Vector3d> HemisphereDirections(int count, const Eigen::Vector3d& up);

// The same over the whole sphere: half of them about +z, and their opposites. count is even.
std::vector<Eigen::Vector3d> SphereDirections(int count);

}  // namespace turnlight::estimator::model
