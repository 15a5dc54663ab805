// Whether the pictures ask for other normals: all of them tilted together, as those of a target
// that is registered a little wrong.
#pragma once

#include <Eigen/Core>
#include <array>

#include "estimator/observations.h"
#include "estimator/solver.h"

namespace turnlight::estimator {

// Of a tilt by one angle (radians) about an axis: the cost's slope and curvature, and how the
// gradient of the solver's columns changes with it.
struct TiltResponse {
  Eigen::VectorXd mixed;
  double slope = 0.0, curvature = 0.0;
};
struct TiltResponses {
  NormalEquations untilted;  // of the same pixels
  std::array<TiltResponse, 3> axes;
};

// On at most 50 000 of the pixels, by central differences. The axes are the target's where
// observations know its poses (what can shadow itself), else W's.
TiltResponses TiltNormals(const Observations& observations, const Solution& solution);

}  // namespace turnlight::estimator
