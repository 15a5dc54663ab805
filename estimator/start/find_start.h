// Where the full solve starts.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "base/stop_flag.h"
#include "estimator/model/initial_guess.h"
#include "estimator/model/model_choice.h"
#include "estimator/model/rung.h"
#include "estimator/model/scene.h"
#include "estimator/observe/intensity_map.h"
#include "estimator/observe/observations.h"
#include "estimator/start/usual_models.h"

namespace turnlight::estimator::start {

struct Start {
  model::Scene scene;               // in the observations' coordinates
  std::vector<model::Rung> ladder;  // the decisions on the way
  std::vector<double> rms_history;  // of the residual on the sample, on the way
  // Candidate's, of the lights that were kept.
  double least_kept = std::numeric_limits<double>::infinity();
};

// On a sample of the pixels: from the guess, or from the map's clusters and what else leads
// further; with the diffuse model, the lobe and the lights that matter on pixels held out. noise:
// sigma of a value. With stop set it ends soon, with a start that is of no use; and where `beyond`
// says so.
Start FindStart(const observe::Observations& all, double noise, const observe::IntensityMap& map,
                const std::optional<model::InitialGuess>& guess, const model::ModelChoice& choice,
                const StopFlag* stop = nullptr, const Beyond& beyond = {});

}  // namespace turnlight::estimator::start
