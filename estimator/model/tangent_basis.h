// Coordinates for a step of a direction: two axes across it.
#pragma once

#include <Eigen/Core>

namespace turnlight::estimator::model {

// Two unit vectors that with unit u form a right-handed basis (u, e1, e2 orthonormal). Duff et al.,
// "Building an Orthonormal Basis, Revisited" (JCGT 2017).
Eigen::Matrix<double, 3, 2> TangentBasis(const Eigen::Vector3d& u);

}  // namespace turnlight::estimator::model
