// How the cost of a fit answers to something that the model holds fixed, by how that changes the
// model's picture (Gauss-Newton: beside a direction that the fit's parameters can nearly follow,
// second derivatives of the residuals would be mere noise).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimator/normal_equations.h"
#include "estimator/prediction.h"

namespace turnlight::estimator {

// to += factor * what.
void AddTimes(double factor, const Prediction& what, Prediction& to);

// Of one number that is 0 in the model: the cost's slope and curvature by it, and how the gradient
// of the solver's columns changes with it.
struct Effect {
  Eigen::VectorXd mixed;
  double slope = 0.0, curvature = 0.0;
};

// A fit, ready to be asked. Residuals weigh what they do in the loss. All must outlive it.
class EffectProbe {
 public:
  EffectProbe(const Observations& pixels, const Scene& scene, const EvaluateOptions& options);
  const Prediction& model() const { return model_; }
  // Of the number that changes the picture by `times` this for each unit.
  Effect Of(const Prediction& change, double times) const;

 private:
  const Observations& pixels_;
  const Scene& scene_;
  EvaluateOptions squares_;
  Prediction model_;
  std::vector<float> weight_;
  Eigen::VectorXd gradient_;
};

}  // namespace turnlight::estimator
