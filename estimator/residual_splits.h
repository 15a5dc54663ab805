// What the residuals of a fit say about errors that are not independent noise: gradients of parts
// of the observations at the solution. With the whole gradient zero, what a part alone asks for is
// what the others must balance.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimator/normal_tilt.h"
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
  // What appears when footprints are sampled twice as finely (half as finely where that is not
  // possible), and 4 % of what appears when they are not averaged over at all: how a pixel averages
  // is not known better (a renderer's mean of 5 x 5 points is off by as much).
  Eigen::VectorXd finer, footprint;
  // What the pixels near an attached shadow's edge contribute to the solution's normal equations.
  NormalEquations edges;
  // At the solution, for a surface just rough enough to have a slope (if it is Lambert's).
  NormalEquations alternatives;
  TiltResponses tilts;  // of the normals
};

ResidualSplits SplitResiduals(const Observations& observations, const Solution& solution);

}  // namespace turnlight::estimator
