// What the residuals of a fit say about errors that are not independent noise: gradients of parts
// of the observations at the solution. With the whole gradient zero, what a part alone asks for is
// what the others must balance.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "estimator/observe/observations.h"
#include "estimator/solve/solver.h"
#include "estimator/uncertainty/photograph_errors.h"
#include "estimator/uncertainty/unmodelled.h"

namespace turnlight::estimator::uncertainty {

// Gradients of the cost by the solver's columns (see model::Parameters).
struct ResidualSplits {
  // Of each tile, a column: neighbouring pixels, whose residuals may go together, count as one.
  Eigen::MatrixXd clusters;
  // The same of places in the pictures, each summed over the views: what stays with the picture,
  // as dirt on the lens or uneven gain, goes together from view to view. Empty with one view.
  Eigen::MatrixXd places;
  // The same of squares of a grid over the target, in a single view that is not explained down to
  // noise: what a model lacks goes together over more than a tile. Else empty.
  Eigen::MatrixXd squares;
  // The gradient of one half of the observations; of the other half it is the opposite. Halves: odd
  // and even views, early and late views, centre and rim of the target, bright and dark, and by the
  // side to which the surface faces.
  std::vector<Eigen::VectorXd> halves;
  // What appears when footprints are sampled twice as finely (half as finely where that is not
  // possible).
  Eigen::VectorXd finer;
  // What the pixels near an attached shadow's edge contribute to the solution's normal equations.
  solve::NormalEquations edges;
  // At the solution, for a surface just rough enough to have a slope (if it is Lambert's).
  solve::NormalEquations alternatives;
  // Texture or dirt: how much of the radiance (relative, root mean square) the residuals are that
  // pixels a few apart have in common. 0 if that is not beyond noise, or less than 0.1 %.
  double texture = 0.0;
  Unmodelled unmodelled;
  // Of a photograph, in place of all of the above: its pixels weigh by what a model is expected to
  // leave of them, together or alone.
  std::optional<PhotographErrors> photograph;
};

ResidualSplits SplitResiduals(const observe::Observations& observations,
                              const solve::Solution& solution);

}  // namespace turnlight::estimator::uncertainty
