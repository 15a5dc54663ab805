// A second lobe beside the first: a sharp and a broad one together are common on real surfaces.
#pragma once

#include <vector>

#include "estimator/model/rung.h"
#include "estimator/start/candidate.h"

namespace turnlight::estimator::start {

// The candidate with another lobe of its first one's model, four times as broad or four times as
// sharp to begin with, if that makes the excess variance twice as small without more lights; or as
// sample.choice.lobes says. Not tried where nothing is left to explain, where there is no lobe, and
// where the user chose a lobe without saying how many. The sharper is the first
// to begin with.
Candidate ChooseSecondLobe(const Sample& sample, const Candidate& candidate,
                           std::vector<model::Rung>& ladder);

}  // namespace turnlight::estimator::start
