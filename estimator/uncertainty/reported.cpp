#include "estimator/uncertainty/reported.h"

#include <algorithm>
#include <utility>

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

// The same pictures with one light white: its colour goes to the albedo and to what the
// lobes reflect, and out of the other lights and the ambient light.
model::Scene WithOneWhite(const std::vector<std::size_t>& order, model::Scene scene) {
  if (!order.empty()) {
    // A light that lacks a channel cannot be called white: the strongest is.
    std::size_t white = order[std::min(scene.white_light, order.size() - 1)];
    const auto lacks = [](const Eigen::Vector3d& c) {
      return !(c.minCoeff() > 1e-3 * c.maxCoeff());
    };
    if (lacks(scene.lights[white].color)) white = order[0];
    const Eigen::Vector3d gauge = scene.lights[white].color.cwiseMax(1e-300);
    model::Reflectance& r = scene.reflectance;
    r.albedo = r.albedo.cwiseProduct(gauge);
    r.specular_colour = r.specular_colour.cwiseProduct(gauge);
    r.ambient_colour = r.ambient_colour.cwiseQuotient(gauge);
    for (model::Light& light : scene.lights) light.color = light.color.cwiseQuotient(gauge);
  }
  return model::WithLargestColoursOne(std::move(scene));
}

}  // namespace

Reported Report(const model::Scene& solver_scene, const observe::Observations& observations,
                const std::vector<std::size_t>& order) {
  model::Scene world = solve::ToWorld(solver_scene, observations);
  if (world.free_colours || world.coloured()) world = WithOneWhite(order, std::move(world));
  const std::vector<model::Light>& lights = world.lights;
  Reported out;
  model::Reflectance& r = out.reflectance;
  r = world.reflectance;
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
