// How far noise of the corners moves what was fitted.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "calib/calibrate/lens/problem.h"

namespace turnlight::calib::calibrate::lens {

struct FitNoise {
  double rms_px = 0.0;    // per axis, weighted, of what is not an outlier
  double noise_px = 0.0;  // standard deviation of the same, about their mean, as mrcal takes it
  std::size_t parameters = 0;
};
FitNoise NoiseOf(const Problem& problem, const Linearization& linearization);

// At the optimum, for corners whose noise per axis is noise_px: of the intrinsics, and of the mean
// motion of the boards, as ProjectionUncertainty wants it. What regularizes counts as mrcal counts
// it: it holds parameters, but has no noise. Nothing if the problem is singular.
std::optional<Eigen::MatrixXd> CalibrationCovariance(const Problem& problem,
                                                     const Linearization& linearization,
                                                     double noise_px);

}  // namespace turnlight::calib::calibrate::lens
