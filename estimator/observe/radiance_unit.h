// Thresholds are shares of white, for pictures that were exposed for what they show. The radiances
// of others are divided by a power of two, so that the brightest is about 1, as lengths are divided
// by the target's radius: thresholds are then shares of that level.
#pragma once

#include "estimator/observe/observations.h"

namespace turnlight::estimator::observe {

// A power of two that brings the brightest radiance (99.9 % quantile) to about 1; 1 for most, and
// for pictures without light.
double RadianceUnit(double brightest);

// Of observations in white: their radiances and variances into the unit that suits them.
void SetRadianceUnit(Observations& observations);

}  // namespace turnlight::estimator::observe
