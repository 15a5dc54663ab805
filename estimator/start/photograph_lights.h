// The lights of a photograph: from its highlights, on a surface that may depart from every model.
//
// Light l adds I_l [D (1 + sum_j d_j Y_j(n)) + a sharp and a broad lobe], the departures d and the
// lobes being those of all lights: a light that is not there would have to show a highlight of its
// own. A light is kept if taking it out costs more than its price, over all independent pixels or
// where its own highlight is.
#pragma once

#include <cstddef>
#include <vector>

#include "base/stop_flag.h"
#include "estimator/model/model_choice.h"
#include "estimator/model/rung.h"
#include "estimator/model/scene.h"
#include "estimator/observe/photograph.h"

namespace turnlight::estimator::start {

struct PhotographLights {
  model::Scene scene;   // in the coordinates of the photograph's pixels
  double misfit = 0.0;  // mean square of the residuals, in expected sigmas
  std::vector<model::Rung> ladder;
  // What lights are worth, of their price: the least of those that were kept beside others, and the
  // most of those that were not. Both near 1: their number is open.
  double least_kept = 0.0, most_dropped = 0.0;
  // Lights that left the spots that they came from by more than 10 degrees: those spots are dirt or
  // texture, and not highlights.
  std::size_t strays = 0;
};

// Mean square of residuals, in the sigmas that the pixels were given, of a fit's cost.
double MisfitOf(const observe::Observations& pixels, double cost);

// There must be spots. With stop set it ends soon, with what is of no use.
PhotographLights FindPhotographLights(const observe::Photograph& photograph,
                                      const model::ModelChoice& choice,
                                      const StopFlag* stop = nullptr);

}  // namespace turnlight::estimator::start
