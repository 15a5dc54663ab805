// Proves on random points, against what was put in: a light of some extent and a further light are
// seen with their size, a tilt of all normals is undone with the lights, normals wrong each by
// itself are told by how much, and where none of it is there nothing is found. Does not prove what
// sigmas make of it: unknown_errors_test and bench/studies do.
#include "estimator/uncertainty/unmodelled.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/angles.h"
#include "estimator/model/tangent_basis.h"
#include "estimator/observe/observation_access.h"
#include "estimator/solve/matched_filter.h"
#include "estimator/solve/prediction.h"
#include "estimator/uncertainty/normal_errors.h"
#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::uncertainty {
namespace {

using Eigen::Vector3d;

constexpr double kNoise = 0.002;

RandomObservations Noisy(const model::Scene& truth) {
  RandomObservations random(40 * observe::kTile, 3, 3, &truth);
  const RandomStream noise(5, 5);
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < random.observations.used; ++i)
      random.observations.radiance[c][i] += static_cast<float>(kNoise * noise.Normal(3 * i + c));
  return random;
}

// The normal of point i turned, and what it mirrors with it; the radiances stay.
void Turn(observe::Observations& all, std::size_t i, const Eigen::AngleAxisd& by) {
  const Vector3d n = observe::At(all.normal, i), w = observe::At(all.mirrored, i);
  const Vector3d viewer = 2.0 * n.dot(w) * n - w, turned = by * n;
  observe::Put(turned, i, all.normal);
  observe::Put(2.0 * turned.dot(viewer) * turned - viewer, i, all.mirrored);
}

double WorstAngleDeg(const model::Scene& a, const model::Scene& b) {
  double worst = 0.0;
  for (std::size_t l = 0; l < a.lights.size(); ++l)
    worst = std::max(
        worst,
        RadToDeg(std::acos(std::min(1.0, a.lights[l].direction.dot(b.lights[l].direction)))));
  return worst;
}

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
  solution.held.assign(static_cast<std::size_t>(solve::Columns{3, 2}.count()), false);
  const Unmodelled unmodelled = TryUnmodelled(random.observations, solution);
  ASSERT_EQ(unmodelled.extents.size(), 6u);
  const Score& extent = unmodelled.extents[0];
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
  solution.held.assign(static_cast<std::size_t>(solve::Columns{3, 2}.count()), false);
  const Score aperture = TryUnmodelled(all, solution).aperture;
  ASSERT_GT(aperture.curvature, 0.0);
  EXPECT_NEAR(-aperture.slope / aperture.curvature, kShare - 1.0, 0.01);
}

TEST(Unmodelled, OneMoreLightIsFoundWhereItIs) {
  const model::Scene scene = TwoLights();
  model::Scene more = scene;
  more.lights.push_back({Vector3d(0.1, -0.8, 0.4).normalized(), 0.05, 0.02, Vector3d::Ones()});
  const RandomObservations random(20 * observe::kTile, 3, 3, &more);
  const auto light = solve::MostMissingLight(random.observations, scene);
  ASSERT_TRUE(light.has_value());
  EXPECT_GT(light->direction.dot(more.lights[2].direction), std::cos(DegToRad(15.0)));
  EXPECT_NEAR(light->intensity, 0.02, 0.01);
}

TEST(NormalErrors, ATiltIsUndoneWithTheLights) {
  const model::Scene truth = TwoLights();
  RandomObservations random = Noisy(truth);
  observe::Observations& all = random.observations;
  for (std::size_t i = 0; i < all.used; ++i)
    Turn(all, i, Eigen::AngleAxisd(DegToRad(8.0), Vector3d(1.0, 0.4, 0.2).normalized()));
  const solve::Solution solution = solve::Solve(all, truth, {});
  ASSERT_GT(WorstAngleDeg(solution.scene, truth), 5.0);
  const Unmodelled unmodelled = TryUnmodelled(all, solution);
  ASSERT_TRUE(unmodelled.tilted_scene.has_value());
  EXPECT_LT(WorstAngleDeg(*unmodelled.tilted_scene, truth), 0.3);
}

TEST(NormalErrors, ScatteredNormalsAreToldByHowMuch) {
  const model::Scene truth = TwoLights();
  for (const double angle_deg : {0.5, 2.0}) {
    RandomObservations random = Noisy(truth);
    observe::Observations& all = random.observations;
    const RandomStream axes(6, 6);
    for (std::size_t i = 0; i < all.used; ++i) {
      const Vector3d n = observe::At(all.normal, i);
      Turn(all, i,
           Eigen::AngleAxisd(DegToRad(angle_deg), n.cross(RandomUnit(axes, i)).normalized()));
    }
    const solve::Solution solution = solve::Solve(all, truth, {});
    // Turned by one angle about any axis across: half of its square along each.
    const double expected = std::pow(DegToRad(angle_deg), 2) / 2.0;
    EXPECT_NEAR(TryUnmodelled(all, solution).normal_variance, expected, 0.3 * expected)
        << angle_deg;
  }
}

TEST(Unmodelled, WhereNothingIsLeftOutNothingIsFound) {
  const model::Scene truth = TwoLights();
  const RandomObservations random = Noisy(truth);
  const solve::Solution solution = solve::Solve(random.observations, truth, {});
  const Unmodelled unmodelled = TryUnmodelled(random.observations, solution);
  EXPECT_EQ(unmodelled.normal_variance, 0.0);
  EXPECT_FALSE(unmodelled.tilted_scene.has_value());
  for (const Score& tilt : unmodelled.tilts)
    EXPECT_LT(std::abs(tilt.slope / tilt.curvature), 1e-3) << "radians, beside noise of 0.002";
}

}  // namespace
}  // namespace turnlight::estimator::uncertainty
