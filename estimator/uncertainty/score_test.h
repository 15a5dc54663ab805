// Score tests (Rao, 1948) of numbers that the model holds at 0: whether the pictures ask for them,
// and how the fit's parameters would change with them.
//
// Of such a number q, by how q changes the model's picture: the score is the cost's slope by q at
// 0, with the cost's curvature c by q and the cross-Hessian m between q and the fit's parameters,
// all to first order in the picture (Gauss-Newton: beside a direction that the parameters can
// nearly follow, second derivatives of the residuals would be mere noise). The parameters are
// nuisances. By their regression b = H^-1 m on q they take part of it up: s' = s - b.g and c' = c -
// m.b. Then s'^2 / (c' v), v the variance of a value, is chi squared with one degree of freedom if
// q is 0; the best q is -s' / c', and with it the parameters move by b s' / c'.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimator/solve/normal_equations.h"
#include "estimator/solve/prediction.h"

namespace turnlight::estimator::uncertainty {

// to += factor * what.
void AddTimes(double factor, const solve::Prediction& what, solve::Prediction& to);

struct Score {
  Eigen::VectorXd cross_hessian;        // m, by the solver's columns
  double slope = 0.0, curvature = 0.0;  // s and c
};

// A score with the nuisance parameters free to follow.
struct AdjustedScore {
  double slope = 0.0, curvature = 0.0;  // s' and c'
  Eigen::VectorXd regression;           // b, by the nuisance parameters
  // The test's statistic, in squared sigmas. variance: of a value.
  double Statistic(double variance) const { return slope * slope / curvature / variance; }
};

// A fit, ready to be asked. Residuals weigh what they do in the loss. All must outlive it.
class ScoreProbe {
 public:
  ScoreProbe(const observe::Observations& pixels, const model::Scene& scene,
             const solve::EvaluateOptions& options);
  const solve::Prediction& model() const { return model_; }
  // Of the number that changes the picture by `times` this for each unit.
  Score Of(const solve::Prediction& change, double times) const;

 private:
  const observe::Observations& pixels_;
  const model::Scene& scene_;
  solve::EvaluateOptions squares_;
  solve::Prediction model_;
  std::vector<float> weight_;
  Eigen::VectorXd gradient_;
};

}  // namespace turnlight::estimator::uncertainty
