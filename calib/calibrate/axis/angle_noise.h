// How noisy the corners are, and how far the table stood from the angles that it reports: two
// variances, told apart by restricted maximum likelihood (Patterson and Thompson, "Recovery of
// inter-block information when block sizes are unequal", Biometrika 1971), the deviations of the
// views being random effects that are integrated out.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace turnlight::calib::calibrate::axis {

// One view's part of the normal equations: x by parameters, z by its deviation, y the residuals
// with the deviation put back. Signs as residuals go: y = y0 + x step + z deviation.
struct ViewSums {
  Eigen::MatrixXd xx;
  Eigen::VectorXd xz, xy;
  double zz = 0.0, zy = 0.0, yy = 0.0;
  int rows = 0;
  bool free_angle = false;  // its deviation has no prior
};

struct NoiseEstimate {
  double corner = 0.0;     // sigma of a residual
  double angle = 0.0;      // sigma of a deviation
  int corner_freedom = 0;  // degrees of freedom
  int angle_freedom = 0;
};

// What the sums say, the corners' sigma being at least `least_corner`. angle_freedom: the views
// less what scale, board and backlash take.
NoiseEstimate EstimateNoise(const std::vector<ViewSums>& views, int angle_parameters,
                            double least_corner);

// The normal matrix with the deviations integrated out, in units of the corners' variance.
Eigen::MatrixXd MarginalNormal(const std::vector<ViewSums>& views, double variance_ratio);
// Of a view: X'X -> X'X - share xz z'X.
double DeviationShare(const ViewSums& view, double variance_ratio);

}  // namespace turnlight::calib::calibrate::axis
