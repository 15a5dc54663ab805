// What pixels at white and beside them are worth.
#pragma once

#include <vector>

#include "estimator/model/rung.h"
#include "estimator/select/refined.h"

namespace turnlight::estimator::select {

// Pixels at white and their neighbours were held back (Observations::held_back). Now that the model
// is known it tells whether those beside are explained as well as all others, or charge has spilled
// over to them. If they are, all are taken in, those at white one-sided, and everything is solved
// on; if not, they stay out.
void ChooseClipped(double noise, observe::Observations& observations, Refined& out,
                   std::vector<model::Rung>& ladder);

}  // namespace turnlight::estimator::select
