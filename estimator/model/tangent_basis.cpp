#include "estimator/model/tangent_basis.h"

#include <cmath>

namespace turnlight::estimator::model {

Eigen::Matrix<double, 3, 2> TangentBasis(const Eigen::Vector3d& u) {
  const double sign = std::copysign(1.0, u.z());
  const double a = -1.0 / (sign + u.z());
  const double b = u.x() * u.y() * a;
  Eigen::Matrix<double, 3, 2> basis;
  basis << 1.0 + sign * u.x() * u.x() * a, b,  //
      sign * b, sign + u.y() * u.y() * a,      //
      -sign * u.x(), -u.y();
  return basis;
}

}  // namespace turnlight::estimator::model
