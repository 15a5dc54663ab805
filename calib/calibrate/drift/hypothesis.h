// What fits the pictures if these causes of drift, and no others, were at work: least squares with
// the stored calibration's own uncertainty as random effects, so that what it may have wrong is no
// drift. Internal to this folder.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/calibrate/drift/rig_change.h"
#include "calib/calibrate/drift/sights.h"

namespace turnlight::calib::calibrate::drift {

// What the pictures have that is no drift; sigmas.
struct Nuisances {
  double angle_deg = 0.05;   // of the table at each view
  double edge_offset = 0.2;  // pixels, of outlines: blur and shading
  // Pixels, of outlines: what shading does alike in all views, for each of its harmonics over the
  // outline's direction in the picture.
  double shading = 0.0;
};

struct Hypothesis {
  std::vector<Cause> causes;
  bool stored_errors = true;  // false: the stored calibration is taken as it is
};

// Which residuals count, and how noisy they are.
struct Sifted {
  std::vector<bool> used;  // empty: all, by Tukey's weights
  double noise = 0.3;      // pixels: sigma of a residual whose own is 1
  double correlation = 1.0;
};

struct HypothesisFit {
  Hypothesis hypothesis;
  std::vector<placement::Residual> residuals;
  double misfit = 0.0;    // chi-squared, with the priors
  Eigen::VectorXd drift;  // Layout's step: what the causes did, as far as pictures tell
  Eigen::MatrixXd covariance, from_pictures;  // of drift; without the stored calibration's share
  // Of drift before any picture, and of that the directions that the pictures tell.
  Eigen::MatrixXd could_be, told;
  double freedom = 0.0;  // of the drift: how many numbers the pictures tell
  double taken = 0.0;    // degrees of freedom that all unknowns took
};

HypothesisFit FitHypothesis(const Sights& sights, const Hypothesis& hypothesis,
                            const Nuisances& nuisances, const Sifted& sifted);

// The noise and the outliers, from the fit with all causes.
Sifted Sift(const Sights& sights, const std::vector<Cause>& causes, const Nuisances& nuisances);

}  // namespace turnlight::calib::calibrate::drift
