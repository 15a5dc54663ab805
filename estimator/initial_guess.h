// A start that the user gives.
#pragma once

#include <optional>
#include <vector>

#include "estimator/initial_values.h"
#include "estimator/intensity_map.h"
#include "estimator/rung.h"

namespace turnlight::estimator {

// Directions are required, everything else is estimated where absent. In W.
struct InitialGuess {
  std::vector<Light> lights;  // an inverse distance of 0 means "not given"
  bool has_intensities = false;
  std::optional<Reflectance> reflectance;
};

// The guess, fitted to the sample. If that does not explain the pictures, as many lights are looked
// for without it, and taken if they leave a third of the excess variance or less: directions tens
// of degrees off lead elsewhere.
Candidate FitGuess(const Sample& sample, const InitialGuess& guess,
                   const std::vector<MapPoint>& clusters, std::vector<Rung>& ladder);

}  // namespace turnlight::estimator
