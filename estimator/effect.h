// How the cost of a fit answers to something that the model holds fixed.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "estimator/normal_equations.h"

namespace turnlight::estimator {

// Of one number that is 0 in the model: the cost's slope and curvature by it, and how the gradient
// of the solver's columns changes with it.
struct Effect {
  Eigen::VectorXd mixed;
  double slope = 0.0, curvature = 0.0;
};

// The cost's answer at `at(x)`, from both sides of 0. `zero`: at(0).
inline Effect CentralEffect(const std::function<NormalEquations(double)>& at,
                            const NormalEquations& zero, double step) {
  const NormalEquations up = at(step), down = at(-step);
  return {(up.gradient - down.gradient) / (2.0 * step), (up.cost - down.cost) / (2.0 * step),
          (up.cost + down.cost - 2.0 * zero.cost) / (step * step)};
}

}  // namespace turnlight::estimator
