// What a fit with too few lights leaves in its residual: where further lights would help.
#pragma once

#include "estimator/initial_values.h"

namespace turnlight::estimator {

// A matched filter: how much a weak light from each of many directions would lower the cost, its
// peaks added as lights, and everything fitted and thinned out again; as long as each round makes
// the excess variance three times smaller. Returns the candidate itself if nothing helps.
Candidate AddMissingLights(const Observations& sample, Candidate candidate, double noise);

}  // namespace turnlight::estimator
