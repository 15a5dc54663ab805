// The fit behind an estimate, in the coordinates that it was made in: what a forecast of further
// views begins with.
#pragma once

#include "estimator/model/scene.h"
#include "estimator/observe/observations.h"
#include "estimator/uncertainty/direction_forecast.h"

namespace turnlight::estimator {

struct FitState {
  model::Scene scene;  // in the observations' coordinates; its lights in the solver's order
  observe::ObservationFrame frame;
  double kept_share = 1.0;  // of the pixels that could be used
  // What the loss leaves of a pixel's information, mean over the unknowns; 1: plain squares.
  double loss_share = 1.0;
  bool photograph = false;                    // its pixels weigh by what a model leaves of them
  uncertainty::DirectionForecast directions;  // lights as in the estimate
};

}  // namespace turnlight::estimator
