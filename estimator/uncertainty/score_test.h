// How the cost of a fit answers to something that the model holds fixed, by how that changes the
// model's picture (Gauss-Newton: beside a direction that the fit's parameters can nearly follow,
// second derivatives of the residuals would be mere noise).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimator/solve/normal_equations.h"
#include "estimator/solve/prediction.h"

namespace turnlight::estimator::uncertainty {

// to += factor * what.
void AddTimes(double factor, const solve::Prediction& what, solve::Prediction& to);

// Of one number that is 0 in the model: the cost's slope and curvature by it, and how the gradient
// of the solver's columns changes with it.
struct Effect {
  Eigen::VectorXd mixed;
  double slope = 0.0, curvature = 0.0;
};

// A fit, ready to be asked. Residuals weigh what they do in the loss. All must outlive it.
class EffectProbe {
 public:
  EffectProbe(const observe::Observations& pixels, const model::Scene& scene,
              const solve::EvaluateOptions& options);
  const solve::Prediction& model() const { return model_; }
  // Of the number that changes the picture by `times` this for each unit.
  Effect Of(const solve::Prediction& change, double times) const;

 private:
  const observe::Observations& pixels_;
  const model::Scene& scene_;
  solve::EvaluateOptions squares_;
  solve::Prediction model_;
  std::vector<float> weight_;
  Eigen::VectorXd gradient_;
};

}  // namespace turnlight::estimator::uncertainty
