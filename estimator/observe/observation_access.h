// One pixel's vectors out of the observations' arrays, in double precision.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "estimator/observe/observations.h"

namespace turnlight::estimator::observe {

inline Eigen::Vector3d At(const std::array<std::vector<float>, 3>& from, std::size_t i) {
  return {static_cast<double>(from[0][i]), static_cast<double>(from[1][i]),
          static_cast<double>(from[2][i])};
}

inline Eigen::Vector3d At(const std::array<std::vector<BFloat16>, 6>& from, std::size_t first,
                          std::size_t i) {
  return {static_cast<double>(FromBFloat16(from[first][i])),
          static_cast<double>(FromBFloat16(from[first + 1][i])),
          static_cast<double>(FromBFloat16(from[first + 2][i]))};
}

inline void Put(const Eigen::Vector3d& value, std::size_t i,
                std::array<std::vector<float>, 3>& to) {
  for (int k = 0; k < 3; ++k) to[static_cast<std::size_t>(k)][i] = static_cast<float>(value[k]);
}

}  // namespace turnlight::estimator::observe
