// Lights that the pictures cannot tell apart, as one.
#pragma once

#include "estimator/start/candidate.h"

namespace turnlight::estimator::start {

// Fits a start with perhaps too many lights, then merges lights that are closer than their lobe can
// tell apart, removes the negligible, and fits again, while that changes anything. Not below
// sample.choice.lights, if that is given.
Candidate FitAndMerge(const Sample& sample, const model::Scene& start);

}  // namespace turnlight::estimator::start
