// What a fit with too few lights leaves in its residual: where further lights would help.
#pragma once

#include <optional>

#include "estimator/initial_values.h"

namespace turnlight::estimator {

// A matched filter: how much a weak light from each of many directions would lower the cost, its
// peaks added as lights and everything fitted again, as long as that helps; then thinned out.
// Returns the candidate itself if the excess variance does not get three times smaller. With
// sample.choice.lights it goes on to so many, whether they help or not.
Candidate AddMissingLights(const Sample& sample, Candidate candidate);

// Of the same directions the one whose light would lower the cost the most, all else held, with its
// best intensity. None if none would.
std::optional<Light> MostMissingLight(const Observations& pixels, const Scene& scene);

}  // namespace turnlight::estimator
