// From an information matrix to a covariance, without the directions that the data do not see.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace turnlight::estimator::uncertainty {

// The inverse of the information matrix over the unknowns, without the directions in which it is
// singular.
struct Covariance {
  std::vector<int> unknowns;       // columns that are not held
  Eigen::MatrixXd matrix;          // over the unknowns
  std::vector<bool> undetermined;  // per unknown: it has a part in a singular direction
  double condition = 0.0;
  std::vector<std::string> weak;
  double variance = 0.0;  // of a value; matrix is this times H^-1
  // Directions over the unknowns, each scaled to the matrix's unit diagonal, that the data hardly
  // see; `weak` are their names.
  std::vector<Eigen::VectorXd> weak_directions;
};

// Of the information matrix over the unknowns, symmetric, and the variance of a value. unknowns and
// weak stay empty.
Covariance InvertInformation(const Eigen::MatrixXd& hessian, double variance);

// Of the one-sigma ellipse of two coordinates: what one number says of a direction.
double LongerHalfAxis(const Eigen::Matrix2d& covariance);

}  // namespace turnlight::estimator::uncertainty
