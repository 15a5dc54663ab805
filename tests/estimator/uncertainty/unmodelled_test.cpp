// Proves on random points, against what was put in: a light of some extent and another aperture are
// seen with their size, a missing light is asked for, and where none of it is there nothing is
// found. Normals that are wrong: normal_errors_test. Does not prove what sigmas make of it:
// unknown_errors_test and bench/studies do.
#include "estimator/uncertainty/unmodelled.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "estimator/model/tangent_basis.h"
#include "estimator/solve/prediction.h"
#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::uncertainty {
namespace {

using Eigen::Vector3d;

TEST(Unmodelled, ALightOfSomeExtentHasItsVariance) {
  const model::Scene scene = TwoLights();
  const Vector3d axis = model::TangentBasis(scene.lights[0].direction).col(0);
  constexpr double kApart = 0.02;  // radians
  model::Scene split = scene;
  split.lights.push_back(scene.lights[0]);
  for (const std::size_t half : {0u, 2u}) {
    const Vector3d u = scene.lights[0].direction + (half == 0 ? kApart : -kApart) * axis;
    split.lights[half].direction = u.normalized();
    split.lights[half].intensity *= 0.5;
  }
  const RandomObservations random(20 * observe::kTile, 3, 3, &split);
  solve::Solution solution;
  solution.scene = scene;
  solution.held.assign(static_cast<std::size_t>(PlainParameters(3, 2).count()), false);
  const Unmodelled unmodelled = TryUnmodelled(random.observations, solution);
  ASSERT_EQ(unmodelled.extents.size(), 2u);
  const Score& extent = unmodelled.extents[0][0];
  // To first order: the lobe's fourth derivative is a tenth of it here.
  EXPECT_NEAR(-extent.slope / extent.curvature, kApart * kApart, 0.15 * kApart * kApart);
}

// Pictures of pixels that average over nine tenths of the width.
TEST(Unmodelled, AnotherApertureIsToldByHowMuch) {
  constexpr double kShare = 0.9;
  const model::Scene scene = TwoLights();
  RandomObservations random(20 * observe::kTile, 3, 3, &scene);
  observe::Observations& all = random.observations;
  // The mirrored ray changes by an eighth and a quarter of a radian across a pixel.
  std::fill(all.footprint[0].begin(), all.footprint[0].end(), observe::ToBFloat16(0.125f));
  std::fill(all.footprint[4].begin(), all.footprint[4].end(), observe::ToBFloat16(0.25f));
  solve::EvaluateOptions narrower;
  narrower.samples_per_side.assign(all.tiles(), 2);
  narrower.aperture *= kShare;
  const solve::Prediction pictures = solve::Predict(all, scene, narrower);
  for (std::size_t c = 0; c < pictures.size(); ++c) all.radiance[c] = pictures[c];
  solve::Solution solution;
  solution.scene = scene;
  solution.held.assign(static_cast<std::size_t>(PlainParameters(3, 2).count()), false);
  const Score aperture = TryUnmodelled(all, solution).aperture;
  ASSERT_GT(aperture.curvature, 0.0);
  EXPECT_NEAR(-aperture.slope / aperture.curvature, kShare - 1.0, 0.01);
}

TEST(Unmodelled, OneMoreLightIsAskedForWithItsIntensity) {
  const model::Scene scene = TwoLights();
  model::Scene more = scene;
  more.lights.push_back({Vector3d(0.1, -0.8, 0.4).normalized(), 0.05, 0.02, Vector3d::Ones()});
  const RandomObservations random(20 * observe::kTile, 3, 3, &more);
  solve::Solution solution;
  solution.scene = scene;
  solution.held.assign(static_cast<std::size_t>(PlainParameters(3, 2).count()), false);
  const auto light = TryUnmodelled(random.observations, solution).light;
  ASSERT_TRUE(light.has_value());
  EXPECT_NEAR(-light->slope / light->curvature, 0.02, 0.01);
}

TEST(Unmodelled, WhereNothingIsLeftOutNothingIsFound) {
  const model::Scene truth = TwoLights();
  const RandomObservations random = NoisyObservations(truth);
  const solve::Solution solution = solve::Solve(random.observations, truth, {});
  const Unmodelled unmodelled = TryUnmodelled(random.observations, solution);
  EXPECT_EQ(unmodelled.normal_variance, 0.0);
  EXPECT_FALSE(unmodelled.tilted_scene.has_value());
  for (const Score& tilt : unmodelled.tilts)
    EXPECT_LT(std::abs(tilt.slope / tilt.curvature), 1e-3) << "radians, beside noise of 0.002";
}

}  // namespace
}  // namespace turnlight::estimator::uncertainty
