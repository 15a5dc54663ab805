#include "estimator/solve/coordinates.h"

namespace turnlight::estimator::solve {
namespace {

// What the picture is linear in.
void Scale(model::Reflectance& reflectance, double by) {
  reflectance.ambient *= by;
  reflectance.harmonics *= by;
  reflectance.diffuse *= by;
  for (model::Lobe& lobe : reflectance.lobes) lobe.strength *= by;
}

}  // namespace

model::DistanceRange ToSolver(const model::DistanceRange& range,
                              const observe::Observations& observations) {
  if (!range.known()) return {};
  return {range.least / observations.radius, range.most / observations.radius,
          -observations.reference / observations.radius};
}

model::Scene ToSolver(const model::Scene& scene, const observe::Observations& observations) {
  model::Scene out = scene;
  for (model::Light& light : out.lights) {
    light = model::Recentred(light, observations.reference);
    light.inverse_distance *= observations.radius;
  }
  out.distance = ToSolver(scene.distance, observations);
  Scale(out.reflectance, 1.0 / observations.radiance_unit);
  return out;
}

model::Scene ToWorld(const model::Scene& scene, const observe::Observations& observations) {
  model::Scene out = scene;
  for (model::Light& light : out.lights) {
    light.inverse_distance /= observations.radius;
    light = model::Recentred(light, -observations.reference);
  }
  if (out.distance.known())
    out.distance = {scene.distance.least * observations.radius,
                    scene.distance.most * observations.radius};
  Scale(out.reflectance, observations.radiance_unit);
  return out;
}

}  // namespace turnlight::estimator::solve
