// From a start that the user gives.
#pragma once

#include <vector>

#include "estimator/candidate.h"
#include "estimator/initial_guess.h"
#include "estimator/intensity_map.h"
#include "estimator/rung.h"

namespace turnlight::estimator {

// The guess, fitted to the sample. If that does not explain the pictures, as many lights are looked
// for without it, and taken if they leave a third of the excess variance or less: directions tens
// of degrees off lead elsewhere.
Candidate FitGuess(const Sample& sample, const InitialGuess& guess,
                   const std::vector<MapPoint>& clusters, std::vector<Rung>& ladder);

}  // namespace turnlight::estimator
