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
    return model::Strength(world.lights[a]) > model::Strength(world.lights[b]);
  });
  return order;
}

namespace {

// The largest channel of a colour becomes 1, and what it multiplies takes the rest.
void Normalise(Eigen::Vector3d& colour, double& strength) {
  const double largest = std::max(colour.maxCoeff(), 1e-300);
  colour /= largest;
  strength *= largest;
}

// The same pictures with one light white: its colour goes to the albedo and to what the
// lobes reflect, and out of the other lights and the ambient light.
void MakeWhite(std::size_t number, const std::vector<std::size_t>& order, model::Reflectance& r,
               std::vector<model::Light>& lights) {
  if (!order.empty()) {
    const std::size_t white = order[std::min(number, order.size() - 1)];
    const Eigen::Vector3d gauge = lights[white].color.cwiseMax(1e-300);
    r.albedo = r.albedo.cwiseProduct(gauge);
    r.specular_colour = r.specular_colour.cwiseProduct(gauge);
    r.ambient_colour = r.ambient_colour.cwiseQuotient(gauge);
    for (model::Light& light : lights) light.color = light.color.cwiseQuotient(gauge);
  }
  for (model::Light& light : lights) Normalise(light.color, light.intensity);
  const double largest = std::max(r.ambient_colour.maxCoeff(), 1e-300);
  r.harmonics *= largest;
  Normalise(r.ambient_colour, r.ambient);
  double specular = 1.0;
  Normalise(r.specular_colour, specular);
  for (model::Lobe& lobe : r.lobes) lobe.strength *= specular;
}

}  // namespace

Reported Report(const model::Scene& solver_scene, const observe::Observations& observations,
                const std::vector<std::size_t>& order) {
  const model::Scene world = solve::ToWorld(solver_scene, observations);
  Reported out;
  model::Reflectance& r = out.reflectance;
  r = world.reflectance;
  std::vector<model::Light> lights = world.lights;
  if (world.free_colours || world.coloured()) MakeWhite(world.white_light, order, r, lights);
  const double albedo = std::max(r.albedo.maxCoeff(), 1e-300);
  const double strongest = order.empty() ? 1.0 : std::max(lights[order[0]].intensity, 1e-300);
  r.albedo /= albedo;
  r.ambient *= albedo;
  r.harmonics *= albedo;
  r.diffuse *= albedo * strongest;
  for (model::Lobe& lobe : r.lobes) lobe.strength *= strongest;
  out.ambient_product = r.albedo.cwiseProduct(r.ambient_colour) * r.ambient;
  for (const std::size_t index : order) {
    ReportedLight& light = out.lights.emplace_back();
    light.light = lights[index];
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
