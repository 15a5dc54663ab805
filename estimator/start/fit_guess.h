// From a start that the user gives.
#pragma once

#include <vector>

#include "estimator/model/initial_guess.h"
#include "estimator/model/rung.h"
#include "estimator/observe/intensity_map.h"
#include "estimator/start/candidate.h"

namespace turnlight::estimator::start {

// The guess, fitted to the sample. If that does not explain the pictures, as many lights are looked
// for without it, and taken if they leave a third of the excess variance or less: directions tens
// of degrees off lead elsewhere.
Candidate FitGuess(const Sample& sample, const model::InitialGuess& guess,
                   const std::vector<observe::MapPoint>& clusters,
                   std::vector<model::Rung>& ladder);

}  // namespace turnlight::estimator::start
