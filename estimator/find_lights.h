// The start without a hint: how many lights, about where, and which reflectance they are seen on.
#pragma once

#include <vector>

#include "estimator/candidate.h"
#include "estimator/intensity_map.h"
#include "estimator/rung.h"

namespace turnlight::estimator {

// From the intensity map's clusters; if they and what they miss do not explain the pictures, also
// with Oren-Nayar, from an over-complete lattice of lights, and from the lights of what left the
// least with the other diffuse model. Each is fitted and thinned out, and the best stays: more
// lights must make the excess variance three times smaller, each of them where the diffuse models
// differ; Oren-Nayar 1.25 times.
Candidate FindLights(const Sample& sample, const std::vector<MapPoint>& clusters,
                     std::vector<Rung>& ladder);

// Lambert or Oren-Nayar for these lights, by the same rule.
Candidate ChooseDiffuse(const Sample& sample, const Candidate& candidate,
                        std::vector<Rung>& ladder);

// Phong or Blinn-Phong for these lights: Blinn-Phong only if it makes the excess variance 1.25
// times smaller.
Candidate ChooseLobe(const Sample& sample, const Candidate& candidate, std::vector<Rung>& ladder);

}  // namespace turnlight::estimator
