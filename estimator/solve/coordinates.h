// From W to the coordinates of the observations and back.
#pragma once

#include "estimator/model/scene.h"
#include "estimator/observe/observations.h"

namespace turnlight::estimator::solve {

// Scene in W to the observations' coordinates and back (exact; see Recentred).
model::Scene ToSolver(const model::Scene& scene, const observe::Observations& observations);
model::Scene ToWorld(const model::Scene& scene, const observe::Observations& observations);

}  // namespace turnlight::estimator::solve
