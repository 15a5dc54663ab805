#include "estimator/model/direction_lattice.h"

#include <cmath>
#include <numbers>

#include "estimator/model/tangent_basis.h"

namespace turnlight::estimator::model {

std::vector<Eigen::Vector3d> HemisphereDirections(int count, const Eigen::Vector3d& up) {
  const Eigen::Matrix<double, 3, 2> basis = TangentBasis(up);
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (i + 0.5) / count;
    const double azimuth = 2.0 * std::numbers::pi * i / std::numbers::phi;
    const double r = std::sqrt(1.0 - z * z);
    directions.push_back(z * up +
                         r * (std::cos(azimuth) * basis.col(0) + std::sin(azimuth) * basis.col(1)));
  }
  return directions;
}

std::vector<Eigen::Vector3d> SphereDirections(int count) {
  std::vector<Eigen::Vector3d> directions =
      HemisphereDirections(count / 2, Eigen::Vector3d::UnitZ());
  const std::size_t half = directions.size();
  for (std::size_t i = 0; i < half; ++i) directions.emplace_back(-directions[i]);
  return directions;
}

}  // namespace turnlight::estimator::model
