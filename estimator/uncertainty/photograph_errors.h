// What may be wrong of a light that was found from highlights in photographs: what neither noise
// nor the surface's departures from its model tell.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimator/model/scene.h"
#include "estimator/observe/observations.h"

namespace turnlight::estimator::uncertainty {

struct PhotographErrors {
  // Of each light: along every axis across its direction, radians, for 0.15 pixels of the place of
  // its highlight, which is that of the target's outline and of the lens.
  std::vector<double> place;
  // How its direction changes if it stands 50 radii away instead of at infinity: what a highlight
  // tells is the direction from where it is on the target. Zero of a near light.
  std::vector<Eigen::Vector3d> distance;
};

PhotographErrors ErrorsOfHighlights(const observe::Observations& observations,
                                    const model::Scene& scene);

}  // namespace turnlight::estimator::uncertainty
