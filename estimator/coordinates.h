// From W to the coordinates of the observations and back.
#pragma once

#include "estimator/observations.h"
#include "estimator/scene.h"

namespace turnlight::estimator {

// Scene in W to the observations' coordinates and back (exact; see Recentred).
Scene ToSolver(const Scene& scene, const Observations& observations);
Scene ToWorld(const Scene& scene, const Observations& observations);

}  // namespace turnlight::estimator
