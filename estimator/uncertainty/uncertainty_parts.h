// What a sigma is made of: statistics, and what the model may have wrong. Internal to
// uncertainty.h, which says how the parts are defined.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "estimator/model/parameters.h"
#include "estimator/solve/solver.h"
#include "estimator/uncertainty/budget.h"
#include "estimator/uncertainty/covariance.h"
#include "estimator/uncertainty/residual_splits.h"
#include "estimator/uncertainty/uncertainty.h"

namespace turnlight::estimator::uncertainty {

// Propagation of errors: derivatives of the reported quantities by the unknowns.
struct Propagation {
  Eigen::VectorXd values;
  Eigen::MatrixXd jacobian;
  std::vector<bool> undetermined;  // per quantity: it depends on an undetermined unknown
  double radius = 1.0;             // R: the unknowns' lengths
  Eigen::VectorXd tilt_shift;      // what a large tilt of the normals changes; empty: there is none
};

// Covariances of the reported quantities.
struct Part {
  BudgetWords words;
  Eigen::MatrixXd covariance;
};
struct Parts {
  Eigen::MatrixXd stat, model;
  std::vector<Part> items;        // what model is the sum of
  std::vector<std::string> weak;  // what the model left out and the data do not decide
  CountEvidence count;

  // A shift of all reported quantities counts as one sigma of that item.
  void Add(const BudgetWords& words, const Eigen::VectorXd& shift);
};

Parts PartsOf(const solve::Solution& solution, const model::Parameters& parameters,
              const ResidualSplits& splits, const Covariance& covariance,
              const Propagation& reported, double views_per_distinct,
              const std::vector<std::size_t>& order);

// What the calibration's errors add: items of `parts` that are not in its model.
std::vector<Part> CalibrationParts(const CalibrationResponse& calibration,
                                   const solve::Solution& solution,
                                   const model::Parameters& parameters,
                                   const Covariance& covariance, const Propagation& reported,
                                   const std::vector<std::size_t>& order);

}  // namespace turnlight::estimator::uncertainty
