// What a fit with too few lights leaves in its residual: where further lights would help.
#pragma once

#include "estimator/start/candidate.h"

namespace turnlight::estimator::start {

// The peaks of the matched filter are added as lights and everything is fitted again, as long as
// that helps; then lights are eliminated.
// Returns the candidate itself if that does not lower the score (score.h). With
// sample.choice.lights it goes on to so many, whether they help or not.
Candidate AddMissingLights(const Sample& sample, Candidate candidate);

}  // namespace turnlight::estimator::start
