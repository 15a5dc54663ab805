#include "estimator/solve/coordinates.h"

namespace turnlight::estimator::solve {

model::Scene ToSolver(const model::Scene& scene, const observe::Observations& observations) {
  model::Scene out = scene;
  for (model::Light& light : out.lights) {
    light = model::Recentred(light, observations.reference);
    light.inverse_distance *= observations.radius;
  }
  return out;
}

model::Scene ToWorld(const model::Scene& scene, const observe::Observations& observations) {
  model::Scene out = scene;
  for (model::Light& light : out.lights) {
    light.inverse_distance /= observations.radius;
    light = model::Recentred(light, -observations.reference);
  }
  return out;
}

}  // namespace turnlight::estimator::solve
