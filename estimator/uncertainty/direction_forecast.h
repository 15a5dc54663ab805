// What the sigmas of the lights' directions will be once more views are there.
//
// A view adds its information matrix J^T W J to that of the fit, so the part of a sigma that is
// noise shrinks. What the residuals say of it beyond independent noise (uncertainty.h, clusters)
// stays as many times it as it is; what the model or the calibration may have wrong stays as it
// is, for more of the same pictures have the same errors.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace turnlight::estimator::uncertainty {

struct DirectionForecast {
  std::vector<int> unknowns;  // columns of model::Parameters
  Eigen::MatrixXd hessian;    // J^T W J of the fit, over the unknowns
  double variance = 0.0;      // of a value
  struct Light {
    // Of the direction's two tangent coordinates (radians) by the unknowns.
    Eigen::Matrix<double, 2, Eigen::Dynamic> jacobian;
    Eigen::Vector2d inflation = Eigen::Vector2d::Ones();  // sigma_stat over that of the hessian
    Eigen::Matrix2d floor = Eigen::Matrix2d::Zero();      // the covariance that does not shrink
  };
  std::vector<Light> lights;
};

// Of each light the sigma of its direction, radians: the larger half-axis of the total tangent
// covariance. Infinite where the data do not determine it. more: J^T W J of what is added, over all
// columns of model::Parameters; empty: nothing is.
std::vector<double> ForecastDirections(const DirectionForecast& forecast,
                                       const Eigen::MatrixXd& more = {});
// What stays however many views come.
std::vector<double> FloorOfDirections(const DirectionForecast& forecast);

}  // namespace turnlight::estimator::uncertainty
