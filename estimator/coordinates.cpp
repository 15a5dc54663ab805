#include "estimator/coordinates.h"

namespace turnlight::estimator {

Scene ToSolver(const Scene& scene, const Observations& observations) {
  Scene out = scene;
  for (Light& light : out.lights) {
    light = Recentred(light, observations.reference);
    light.inverse_distance *= observations.radius;
  }
  return out;
}

Scene ToWorld(const Scene& scene, const Observations& observations) {
  Scene out = scene;
  for (Light& light : out.lights) {
    light.inverse_distance /= observations.radius;
    light = Recentred(light, -observations.reference);
  }
  return out;
}

}  // namespace turnlight::estimator
