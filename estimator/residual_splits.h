// What the residuals of a fit say about errors that are not independent noise: gradients of parts
// of the observations at the solution. With the whole gradient zero, what a part alone asks for is
// what the others must balance.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimator/observations.h"
#include "estimator/solver.h"

namespace turnlight::estimator {

// Gradients of the cost by the solver's columns (see Columns).
struct ResidualSplits {
  // Sum over tiles of g g^T: neighbouring pixels, whose residuals may go together, count as one.
  Eigen::MatrixXd clusters;
  std::size_t cluster_count = 0;
  // The gradient of one half of the observations; of the other half it is the opposite. Halves: odd
  // and even views, early and late views, centre and rim of the target, bright and dark, and by the
  // side to which the surface faces.
  std::vector<Eigen::VectorXd> halves;
  // The gradient that appears when footprints are sampled twice as finely.
  Eigen::VectorXd finer;
};

ResidualSplits SplitResiduals(const Observations& observations, const Solution& solution);

}  // namespace turnlight::estimator
