// A photograph's lights, from the search's end to what is reported.
#pragma once

#include <vector>

#include "base/stop_flag.h"
#include "estimator/model/model_choice.h"
#include "estimator/model/rung.h"
#include "estimator/observe/photograph.h"
#include "estimator/select/refined.h"

namespace turnlight::estimator::select {

// Solves on all of the photograph's pixels from the lights that were found, without lobes that came
// to nothing. A light is near only if its inverse distance is 3 sigma from 0 with the diffuse
// part's departures free, which can stand for it; or as `choice` says.
Refined RefinePhotograph(const observe::Observations& pixels, const model::Scene& start,
                         double views_per_distinct, const model::ModelChoice& choice,
                         std::vector<model::Rung>& ladder, const StopFlag* stop = nullptr);

}  // namespace turnlight::estimator::select
