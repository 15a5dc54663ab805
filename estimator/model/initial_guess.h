// A start that the user gives.
#pragma once

#include <optional>
#include <vector>

#include "estimator/model/scene.h"

namespace turnlight::estimator::model {

// Directions are required, everything else is estimated where absent. In W.
struct InitialGuess {
  std::vector<Light> lights;  // an inverse distance of 0 means "not given"
  bool has_intensities = false;
  std::optional<Reflectance> reflectance;
};

}  // namespace turnlight::estimator::model
