// Proves: a start has the directions it was given, lights of equal strength that together shine as
// the median pixel says, and its colour. Does not prove that a solve from there ends well
// (find_lights_test).
#include "estimator/start/start_scene.h"

#include <gtest/gtest.h>

#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::start {
namespace {

using Eigen::Vector3d;

TEST(StartFromDirections, TakesColourAndStrengthFromTheMedian) {
  observe::Observations all = RandomObservations(1001, 3, 1).observations;
  for (std::size_t i = 0; i < all.used; ++i)
    for (int c = 0; c < 3; ++c)
      all.radiance[c][i] = static_cast<float>(i) / 1000.0f * (c == 1 ? 0.4f : 0.8f);
  const std::vector<Vector3d> directions = {Vector3d::UnitX(), Vector3d::UnitZ()};
  const model::Scene start = StartFromDirections(all, directions);
  EXPECT_LT((start.reflectance.albedo - Vector3d(1.0, 0.5, 1.0)).norm(), 1e-6);
  EXPECT_NEAR(start.reflectance.ambient, 0.04, 1e-6) << "a twentieth is darker";
  ASSERT_EQ(start.lights.size(), 2u);
  for (std::size_t l = 0; l < 2; ++l) {
    EXPECT_EQ(start.lights[l].direction, directions[l]);
    EXPECT_EQ(start.lights[l].inverse_distance, 0.05);
    EXPECT_NEAR(start.lights[l].intensity, 0.2, 1e-6) << "half of the median's 0.4";
  }
}

// Noise may be darker than black, and a median may be 0.
TEST(StartFromDirections, IsWithinBoundsHoweverDark) {
  observe::Observations all = RandomObservations(100, 3, 1).observations;
  for (int c = 0; c < 3; ++c) all.radiance[c].assign(all.size(), -0.01f);
  const model::Scene start = StartFromDirections(all, {Vector3d::UnitZ()});
  EXPECT_EQ(start.reflectance.ambient, 0.0);
  EXPECT_GT(start.lights[0].intensity, 0.0);
  EXPECT_EQ(start.reflectance.albedo, Vector3d::Ones());
}

}  // namespace
}  // namespace turnlight::estimator::start
