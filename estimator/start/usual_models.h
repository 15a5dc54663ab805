// Whether pictures are what some usual model describes down to their noise, as renderings are, and
// no photograph of a real surface is.
#pragma once

#include <functional>

#include "estimator/start/candidate.h"

namespace turnlight::estimator::start {

// From these lights (of the sample's coordinates), each lobe on each diffuse model, then what is
// left with colours, factors or harmonics.
bool UsualModelsExplain(const Sample& sample, const model::Scene& lights);

// Asked where the first fit leaves more than noise: whether the search is to end, as something else
// will be done with the pictures.
using Beyond = std::function<bool(const Sample& sample)>;

}  // namespace turnlight::estimator::start
