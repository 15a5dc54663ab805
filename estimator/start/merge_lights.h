// Lights that the pictures cannot tell apart, as one.
#pragma once

#include <cstddef>

#include "estimator/start/candidate.h"

namespace turnlight::estimator::start {

// Fits a start with perhaps too many lights, then merges lights that are closer than their lobe can
// tell apart, removes the negligible, and fits again, while that changes anything. Not below
// sample.choice.lights, if that is given.
Candidate FitAndMerge(const Sample& sample, const model::Scene& start);

// Merges the closest two lights if they are within `angle` (radians) and there are more than
// `least`; whether it did. Intensities and colours add, the rest is the mean, weighted by strength.
bool MergeClosest(model::Scene& scene, double angle, std::size_t least);

}  // namespace turnlight::estimator::start
