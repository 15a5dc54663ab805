// The minimum of a quadratic within bounds: one step of a bounded Levenberg-Marquardt solve.
#pragma once

#include <Eigen/Core>

namespace turnlight::estimator::solve {

// The d that minimises d^T matrix d / 2 + slope^T d with low <= d <= high. matrix: symmetric,
// positive definite but for rows and columns of zeros, whose d stays 0. The box must hold 0; bounds
// may be infinite. An active-set method (Stark and Parker, "Bounded-Variable Least-Squares", 1995,
// on the normal equations): exact up to rounding, and the same bits for the same input.
Eigen::VectorXd MinimiseInBox(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& slope,
                              const Eigen::VectorXd& low, const Eigen::VectorXd& high);

}  // namespace turnlight::estimator::solve
