// An estimate with a near and a distant light, in which every kind of value occurs.
#pragma once

#include "base/angles.h"
#include "estimator/estimate.h"

namespace turnlight::estimator::results {

inline Estimate ExampleEstimate() {
  Estimate e;
  LightEstimate near;
  near.light = {Eigen::Vector3d(0.36, 0.48, 0.8), 1.0 / 700.0, 1.0, {1, 1, 1}};
  near.near = true;
  near.direction_sigma = DegToRad(0.012);
  near.inverse_distance_sigma = 2e-6;
  near.distance = 700.0;
  near.distance_sigma = 1.24;
  near.distance_min = 697.6;
  near.position = Eigen::Vector3d(252, 336, 560);
  near.position_covariance = Eigen::Matrix3d::Identity();
  near.diffuse_product = {0.1, 0.2, 0.3};
  near.specular_product[0] = 0.35;
  LightEstimate distant;
  distant.light = {Eigen::Vector3d::UnitZ(), 0.0, 0.5, {1, 1, 1}};
  distant.intensity_sigma = 0.01;
  distant.distance_min = 9000.0;
  e.lights = {near, distant};
  e.stat.lights.resize(2);
  e.stat.lights[0].direction = DegToRad(0.004);
  e.stat.lights[0].distance = 0.5;
  e.stat.lights[1].distance = 0.5;  // of a distance that is not given
  e.reflectance.albedo = {0.4, 0.9, 1.0};
  e.reflectance.lobes[0].strength = 0.35;
  e.reflectance.lobes[0].shape = 40.0;
  e.sigma.lobes[0].shape = 0.4;
  e.correlation.quantities = {{"distance", "", 0, 1.24}, {"ambient", "", {}, 0.001}};
  e.correlation.matrix.resize(2, 2);
  e.correlation.matrix << 1.0, 0.25, 0.25, 1.0;
  e.condition = 1234.0;
  e.pixels = 4321;
  e.views = 36;
  e.ladder = {{"one more light", false, "it explains 0.01 % of the energy"}};
  e.notes = {{"views-add-nothing", "all views show the same"}};
  e.stopped = solve::Stopped::kTolerance;
  return e;
}

}  // namespace turnlight::estimator::results
