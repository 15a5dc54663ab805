// A matched filter for lights that a scene lacks: of each of 200 directions, 14 degrees apart, by
// how much a weak light at 20 R would lower the cost, all else held. With the cost's slope s and
// curvature c by its intensity, the best intensity is -s / c, and the gain s^2 / (2 c).
#pragma once

#include <optional>
#include <vector>

#include "estimator/model/scene.h"
#include "estimator/observe/observations.h"
#include "estimator/solve/shadows.h"

namespace turnlight::estimator::solve {

struct MissingLight {
  model::Light light;  // in the observations' coordinates, with the intensity that helps most
  double gain = 0.0;   // by which the cost falls
};

// Every direction that would help, the best first. From the normal equations, many lights in one
// pass, summed in single precision. shadows: of the scene's lights, as far as they are known.
std::vector<MissingLight> RankMissingLights(const observe::Observations& pixels,
                                            const model::Scene& scene, const Shadows& shadows);

// The best alone; none if no direction would help. From predictions, a light at a time, summed in
// double precision: a tenth of the work of a pass that also has the directions' cross products.
std::optional<model::Light> MostMissingLight(const observe::Observations& pixels,
                                             const model::Scene& scene);

}  // namespace turnlight::estimator::solve
