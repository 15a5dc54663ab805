// Whether each light matters on pixels that its discovery did not see.
#pragma once

#include <vector>

#include "estimator/initial_values.h"
#include "estimator/rung.h"

namespace turnlight::estimator {

// Removes from the candidate every light that gives 0.2 % or less of the light on held-out pixels,
// or whose absence would not make their residuals larger; fits the rest again on the sample. One
// rung per light. With sample.choice.lights it only says so.
Candidate CheckHeldOut(const Observations& held_out, const Sample& sample, Candidate candidate,
                       std::vector<Rung>& ladder);

}  // namespace turnlight::estimator
