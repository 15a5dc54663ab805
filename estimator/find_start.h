// Where the full solve starts.
#pragma once

#include <optional>
#include <vector>

#include "estimator/initial_guess.h"
#include "estimator/intensity_map.h"
#include "estimator/model_choice.h"
#include "estimator/observations.h"
#include "estimator/rung.h"
#include "estimator/scene.h"

namespace turnlight::estimator {

struct Start {
  Scene scene;                      // in the observations' coordinates
  std::vector<Rung> ladder;         // the decisions on the way
  std::vector<double> rms_history;  // of the residual on the sample, on the way
};

// On a sample of the pixels: from the guess, or from the map's clusters and what else leads
// further; with the diffuse model, the lobe and the lights that matter on pixels held out. noise:
// sigma of a value.
Start FindStart(const Observations& all, double noise, const IntensityMap& map,
                const std::optional<InitialGuess>& guess, const ModelChoice& choice);

}  // namespace turnlight::estimator
