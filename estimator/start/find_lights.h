// The start without a hint: how many lights, about where, and which reflectance they are seen on.
#pragma once

#include <vector>

#include "estimator/model/rung.h"
#include "estimator/observe/intensity_map.h"
#include "estimator/start/candidate.h"
#include "estimator/start/usual_models.h"

namespace turnlight::estimator::start {

// From the intensity map's clusters; if they and what they miss do not explain the pictures, also
// with Oren-Nayar, from an over-complete lattice of lights, and from the lights of what left the
// least with the other diffuse model; where all that leaves too much, and there are colours, also
// with lights of their own colours. Each is fitted and thinned out, until one leaves nothing, and
// the best by the score (score.h) stays. beyond (optional): where it says so the search ends with
// what the clusters led to.
Candidate FindLights(const Sample& sample, const std::vector<observe::MapPoint>& clusters,
                     std::vector<model::Rung>& ladder, const Beyond& beyond = {});

// Lambert or Oren-Nayar for these lights, by the same score.
Candidate ChooseDiffuse(const Sample& sample, const Candidate& candidate,
                        std::vector<model::Rung>& ladder);

// The lobe for these lights, and whether the diffuse part lies under a coat: another lobe than
// Phong's, or a coat, only if the score says so.
Candidate ChooseLobeAndCoat(const Sample& sample, const Candidate& candidate,
                            std::vector<model::Rung>& ladder);

}  // namespace turnlight::estimator::start
