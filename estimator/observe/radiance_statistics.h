// What the observed radiances are as a whole: their noise, their middle, their extremes. In the
// observations' radiance unit.
#pragma once

#include <Eigen/Core>

#include "estimator/observe/observations.h"

namespace turnlight::estimator::observe {

// Standard deviation of the pixels' noise, in radiance: the median absolute second difference along
// rows, which smooth shading hardly moves; of weighted pixels the reference's. An upper bound where
// texture or highlights rule.
double EstimateNoise(const Observations& observations);

// Per-channel median radiance, the paper's start for the diffuse colour (Wood et al., 2000).
Eigen::Vector3d MedianColour(const Observations& observations);

// Of one channel, the value that a twentieth of the pixels is darker than. There must be pixels.
double DarkRadiance(const Observations& observations, int channel);

// At or below this share of white nothing was lit.
inline constexpr double kDarkRadiance = 1e-7;

// 99.9 % quantile of the first channel. There must be pixels.
double BrightestRadiance(const Observations& observations);

}  // namespace turnlight::estimator::observe
