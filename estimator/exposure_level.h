// Thresholds are shares of white, for pictures that were exposed for what they show. Others are
// estimated at a level of about 1, and the estimate is scaled back.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "estimator/estimate.h"
#include "estimator/model/scene.h"
#include "estimator/observe/observations.h"

namespace turnlight::estimator {

// A power of two that brings the brightest radiance (99.9 % quantile) to about 1; 1 for most.
double ExposureLevel(double brightest);

// Radiances times a factor.
void Scale(observe::Observations& observations, double by);
void Scale(model::Reflectance& reflectance, double by);
void Scale(Estimate& estimate, double by);

}  // namespace turnlight::estimator
