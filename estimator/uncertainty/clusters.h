// Residuals that go together, and how much larger variances are for them.
#pragma once

#include <Eigen/Core>

#include "estimator/uncertainty/covariance.h"
#include "estimator/uncertainty/residual_splits.h"

namespace turnlight::estimator::uncertainty {

// The fit, linearised: what makes changes of the reported quantities of gradients.
struct Linearised {
  const Covariance& covariance;
  const Eigen::MatrixXd& jacobian;  // of the reported quantities by the unknowns
  Eigen::MatrixXd inverse;          // H^-1 of the unknowns
  // Variance inflation: by how much the sums of residuals vary more than those of white noise.
  double variance_inflation = 1.0;
  double tile_inflation = 1.0;    // the same by tiles alone
  bool unexplained_view = false;  // a single one, with more than noise left

  double Variance() const { return covariance.variance * variance_inflation; }
};

// Where the residuals of neighbours go together by more than chance, variances are larger: the
// clustered ("sandwich") estimate from the gradients of tiles, places and squares of the splits,
// one after the other. stat: covariance of the reported quantities as of independent residuals; it
// gets larger, correlations stay. Sets what fit has of inflation.
void AllowForClusters(const ResidualSplits& splits, double views_per_distinct, Linearised& fit,
                      Eigen::MatrixXd& stat);

}  // namespace turnlight::estimator::uncertainty
