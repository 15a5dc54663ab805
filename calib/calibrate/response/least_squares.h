// A small least-squares problem without derivatives: Levenberg-Marquardt on differences.
#pragma once

#include <Eigen/Core>
#include <functional>

namespace turnlight::calib::calibrate::response {

using Residuals = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

struct LeastSquares {
  Eigen::VectorXd parameters;
  Eigen::VectorXd residuals;
  // Of the parameters, if residuals have variance 1. Directions that nothing determines are huge.
  Eigen::MatrixXd covariance;
};

// From a start; the residuals must be finite there. scale: by parameter, of a sensible step.
LeastSquares Minimise(const Residuals& residuals, const Eigen::VectorXd& start,
                      const Eigen::VectorXd& scale);

}  // namespace turnlight::calib::calibrate::response
