// From W and radiances in white to the coordinates and the radiance unit of the observations, and
// back.
#pragma once

#include "estimator/model/scene.h"
#include "estimator/observe/observations.h"

namespace turnlight::estimator::solve {

// Scene in W to the observations' coordinates and back (exact; see Recentred). Of the reflectance,
// ambient, diffuse and specular are radiances; the lights' intensities are relative.
model::Scene ToSolver(const model::Scene& scene, const observe::Observations& observations);
model::Scene ToWorld(const model::Scene& scene, const observe::Observations& observations);
// Distances from W's origin.
model::DistanceRange ToSolver(const model::DistanceRange& range,
                              const observe::Observations& observations);

}  // namespace turnlight::estimator::solve
