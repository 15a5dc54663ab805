// One pass over the observations: cost, gradient and Gauss-Newton matrix of the whole problem.
//
// The Jacobian of a pixel's channel c is O_c a_i + b_i for every parameter i that the colours share
// (a: diffuse part, b: specular part, white), so the sum over channels of its outer products is
// that of two rows, not three: with [sum O^2, sum O; sum O, C] = L L^T, the rows L11 a + L21 b and
// L22 b. Rows are accumulated in float lanes, flushed to double every 2048 pixels, and summed over
// fixed chunks in their order: the same bits for any number of threads and any instruction set.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "estimator/model/parameters.h"
#include "estimator/model/scene.h"
#include "estimator/observe/observations.h"
#include "estimator/solve/evaluate_options.h"

namespace turnlight::estimator::solve {

struct FrameFactors;

struct NormalEquations {
  Eigen::MatrixXd hessian;   // J^T J, model::Parameters::count() squared, symmetric
  Eigen::VectorXd gradient;  // J^T r, r = model - observed
  double cost = 0.0;         // sum of r^2 / 2 over pixels and channels; r weighted, if pixels are
  // Where the scene's factors are unknowns: how they were eliminated. Hessian and gradient are of
  // the others then, the factors following them.
  std::shared_ptr<const FrameFactors> factors;
};

// scene is in the observations' coordinates (about the reference, lengths / R). Under coloured
// lights each channel is a problem of its own, and so is its loss: three passes instead of one.
// Under lights that change each keyframe is one; observations must have their tiles by keyframe.
NormalEquations Evaluate(const observe::Observations& observations, const model::Scene& scene,
                         const EvaluateOptions& options);
// The gradient of each tile by itself: columns x tiles. Free factors must be in options.factors.
Eigen::MatrixXd TileGradients(const observe::Observations& observations, const model::Scene& scene,
                              const EvaluateOptions& options);
// As Evaluate in double precision, for tests of derivatives.
NormalEquations EvaluateDouble(const observe::Observations& observations, const model::Scene& scene,
                               const EvaluateOptions& options);

}  // namespace turnlight::estimator::solve
