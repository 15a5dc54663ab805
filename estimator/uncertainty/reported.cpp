#include "estimator/uncertainty/reported.h"

#include <algorithm>

#include "estimator/solve/coordinates.h"

namespace turnlight::estimator::uncertainty {

std::vector<std::size_t> StrengthOrder(const model::Scene& solver_scene,
                                       const observe::Observations& observations) {
  const model::Scene world = solve::ToWorld(solver_scene, observations);
  std::vector<std::size_t> order(world.lights.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return world.lights[a].intensity > world.lights[b].intensity;
  });
  return order;
}

Reported Report(const model::Scene& solver_scene, const observe::Observations& observations,
                const std::vector<std::size_t>& order) {
  const model::Scene world = solve::ToWorld(solver_scene, observations);
  Reported out;
  model::Reflectance& r = out.reflectance;
  r = world.reflectance;
  const double albedo = std::max(r.albedo.maxCoeff(), 1e-300);
  const double strongest = order.empty() ? 1.0 : std::max(world.lights[order[0]].intensity, 1e-300);
  r.albedo /= albedo;
  r.ambient *= albedo;
  r.diffuse *= albedo * strongest;
  for (model::Lobe& lobe : r.lobes) lobe.strength *= strongest;
  out.ambient_product = r.albedo * r.ambient;
  for (const std::size_t index : order) {
    ReportedLight& light = out.lights.emplace_back();
    light.light = world.lights[index];
    light.light.intensity /= strongest;
    light.direction_at_reference = solver_scene.lights[index].direction;
    light.diffuse_product =
        r.albedo.cwiseProduct(light.light.color) * (r.diffuse * light.light.intensity);
    for (std::size_t k = 0; k < r.lobes.size(); ++k)
      light.specular_product[k] = r.lobes[k].strength * light.light.intensity;
    light.inverse_distance_at_reference = solver_scene.lights[index].inverse_distance;
  }
  return out;
}

}  // namespace turnlight::estimator::uncertainty
