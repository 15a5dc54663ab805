// Whether each light matters on pixels that its discovery did not see.
#pragma once

#include <vector>

#include "estimator/model/rung.h"
#include "estimator/start/candidate.h"

namespace turnlight::estimator::start {

// Removes from the candidate every light without which held-out pixels' residuals would not be
// larger; or not much, their excess variance less than three times as large, if it gives 0.2 % or
// less of their light. (A light near the horizon gives little and may yet be plain to see.) Fits
// the rest again on the sample. One rung per light. With sample.choice.lights it only says so.
Candidate CheckHeldOut(const observe::Observations& held_out, const Sample& sample,
                       Candidate candidate, std::vector<model::Rung>& ladder);

}  // namespace turnlight::estimator::start
