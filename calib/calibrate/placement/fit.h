// Robust least squares of a placement, and its covariance. Internal to this folder and to drift.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "calib/calibrate/placement/residuals.h"

namespace turnlight::calib::calibrate::placement {

struct Problem {
  const rig::RigCalibration& calibration;
  const std::vector<View>& views;
  Model model;
  std::array<bool, kParameters> free{};  // others are held
  double edge_offset_sigma = 0.0;        // pixels, of the prior
  double common_shift_sigma = 0.0;       // pixels, of outlines
  double size = 1.0;                     // of the target, length unit: bounds a step
};

struct Fit {
  State state;
  std::vector<Residual> residuals;  // at the state
  std::vector<bool> used;
  double scale = 1.0;        // sigma of value / sigma
  double correlation = 1.0;  // see Placement
  double rms = 0.0;          // pixels, of those used
  int steps = 0;
  bool converged = false;
};

// Gauss-Newton with Tukey weights while it approaches, then with those within 4 sigma. At most
// `most_steps`. No residuals that count: used is all false.
Fit Solve(const Problem& problem, State start, double reach, int most_steps);

// How well the state fits: the mean over all residuals of the squared value in pixels, limited to
// `limit` squared; points without an expected outline count as the limit.
inline constexpr double kCostLimit = 20.0;  // pixels, for comparing placements
double LimitedCost(const std::vector<Residual>& residuals, double limit);

// The variance of a sum of neighbouring residuals along outlines over that of independent ones, at
// least 1.
double CorrelationOf(const Fit& fit, std::size_t views);

// Of all parameters; those held have none.
struct FitCovariance {
  Eigen::MatrixXd from_outlines, from_calibration;  // 8 x 8
  rig::JointCovariance calibration;                 // of the calibration's parts, without X_AT
  Eigen::MatrixXd with_calibration;                 // 8 x N, between the parameters and those parts
  double wobble = 0.0;                              // pixels
  std::vector<ViewFit> views;
};
FitCovariance CovarianceOf(const Problem& problem, const Fit& fit);

// Information of the parameters (8 x 8) from the residuals used, without the prior.
Eigen::MatrixXd InformationOf(const Problem& problem, const Fit& fit);

// The pose moved by (w, d).
calib::Pose Moved(const calib::Pose& pose, const Eigen::Vector3d& w, const Eigen::Vector3d& d);

}  // namespace turnlight::calib::calibrate::placement
