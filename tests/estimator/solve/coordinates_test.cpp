// Proves: a scene taken to the observations' coordinates shows the same radiances there, in their
// unit, and comes back the same. Does not prove that these coordinates are good ones to solve in.
#include "estimator/solve/coordinates.h"

#include <gtest/gtest.h>

#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::solve {
namespace {

using Eigen::Vector3d;

TEST(Coordinates, RadiancesAreTheSameInBoth) {
  model::Scene scene = TwoLights(0.3, 0.0);
  scene.reflectance.diffuse_model = model::DiffuseModel::kOrenNayar;
  scene.reflectance.roughness = 0.4;
  observe::Observations frame;
  frame.reference = {0.3, -0.2, 0.5};
  frame.radius = 2.5;
  frame.radiance_unit = 0.125;
  const model::Scene solver = ToSolver(scene, frame);
  EXPECT_EQ(solver.lights[1].inverse_distance, 0.0);
  const model::Scene back = ToWorld(solver, frame);
  EXPECT_EQ(back.reflectance.ambient, scene.reflectance.ambient);
  EXPECT_EQ(back.reflectance.diffuse, scene.reflectance.diffuse);
  EXPECT_EQ(back.reflectance.lobes[0].strength, scene.reflectance.lobes[0].strength);
  for (std::size_t l = 0; l < 2; ++l) {
    EXPECT_LT((back.lights[l].direction - scene.lights[l].direction).norm(), 1e-15);
    EXPECT_NEAR(back.lights[l].inverse_distance, scene.lights[l].inverse_distance, 1e-15);
    EXPECT_NEAR(back.lights[l].intensity, scene.lights[l].intensity, 1e-15);
  }
  const RandomStream random(6, 6);
  for (std::uint64_t i = 0; i < 100; ++i) {
    const Vector3d p = 0.7 * RandomUnit(random, i), n = RandomUnit(random, 1000 + i);
    const Vector3d v = (n + 0.5 * RandomUnit(random, 2000 + i)).normalized();
    const Vector3d expected = model::Shade(scene, p, n, v) / frame.radiance_unit;
    EXPECT_LT((model::Shade(solver, (p - frame.reference) / frame.radius, n, v) - expected).norm(),
              1e-12);
  }
}

}  // namespace
}  // namespace turnlight::estimator::solve
