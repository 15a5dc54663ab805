// Proves on random points, against what was put in: the scores of a tilt are the slopes of the cost
// when all normals are really turned, a tilt is undone together with the lights that it moved, and
// normals wrong each by itself are told by how much. Does not prove what sigmas make of it:
// unknown_errors_test and bench/studies do.
#include "estimator/uncertainty/normal_errors.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "estimator/observe/observation_access.h"
#include "estimator/uncertainty/unmodelled.h"
#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::uncertainty {
namespace {

using Eigen::Vector3d;

// The normal of point i turned, and what it mirrors with it; the radiances stay.
void Turn(observe::Observations& all, std::size_t i, const Eigen::AngleAxisd& by) {
  const Vector3d n = observe::At(all.normal, i), w = observe::At(all.mirrored, i);
  const Vector3d viewer = 2.0 * n.dot(w) * n - w, turned = by * n;
  observe::Put(turned, i, all.normal);
  observe::Put(2.0 * turned.dot(viewer) * turned - viewer, i, all.mirrored);
}

// All of them by a rotation vector.
observe::Observations AllTurned(observe::Observations all, const Vector3d& by) {
  for (std::size_t i = 0; i < all.used; ++i)
    Turn(all, i, Eigen::AngleAxisd(by.norm(), by.normalized()));
  return all;
}

TEST(NormalErrors, ScoresAreTheSlopesOfTheCost) {
  const model::Scene scene = TwoLights();
  RandomObservations random(3000, 3, 3, &scene);
  AddNoise(0.05, 5, random.observations);
  const observe::Observations& all = random.observations;
  const ScoreProbe probe(all, scene, {});
  const TiltResponse response = TiltNormals(all, scene, {}, probe);
  for (int axis = 0; axis < 3; ++axis) {
    constexpr double kAngle = 1e-3;
    const auto cost = [&](double angle) {
      return solve::EvaluateDouble(AllTurned(all, angle * Vector3d::Unit(axis)), scene, {}).cost;
    };
    const Score& score = response.scores[static_cast<std::size_t>(axis)];
    const double slope = (cost(kAngle) - cost(-kAngle)) / (2.0 * kAngle);
    // A terminator's kink and single precision leave a little.
    EXPECT_NEAR(score.slope, slope, 0.01 * std::sqrt(score.curvature * 2.0 * cost(0.0)));
    EXPECT_NEAR(response.information(axis, axis), score.curvature, 1e-6 * score.curvature);
  }
  double trace = 0.0;
  for (const double by_any : response.by_any) trace += by_any;
  EXPECT_NEAR(trace, response.information.trace(), 1e-9 * trace);
}

TEST(NormalErrors, ATiltIsUndoneWithTheLights) {
  const model::Scene truth = TwoLights();
  RandomObservations random = NoisyObservations(truth);
  observe::Observations& all = random.observations;
  for (std::size_t i = 0; i < all.used; ++i)
    Turn(all, i, Eigen::AngleAxisd(DegToRad(8.0), Vector3d(1.0, 0.4, 0.2).normalized()));
  const solve::Solution solution = solve::Solve(all, truth, {});
  ASSERT_GT(WorstDirectionDeg(solution.scene.lights, truth.lights), 5.0);
  const Unmodelled unmodelled = TryUnmodelled(all, solution);
  ASSERT_TRUE(unmodelled.tilted_scene.has_value());
  EXPECT_LT(WorstDirectionDeg(unmodelled.tilted_scene->lights, truth.lights), 0.3);
}

TEST(NormalErrors, ScatteredNormalsAreToldByHowMuch) {
  const model::Scene truth = TwoLights();
  for (const double angle_deg : {0.5, 2.0}) {
    RandomObservations random = NoisyObservations(truth);
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

TEST(NormalErrors, WhereNoNormalIsWrongNoneIsSaidToBe) {
  const model::Scene truth = TwoLights();
  const RandomObservations random = NoisyObservations(truth);
  const solve::Solution solution = solve::Solve(random.observations, truth, {});
  const ScoreProbe probe(random.observations, solution.scene, {});
  const TiltResponse response = TiltNormals(random.observations, solution.scene, {}, probe);
  EXPECT_FALSE(FitTilts(random.observations, solution, {}, solution.equations, response));
  EXPECT_EQ(NormalVariance(random.observations, probe.model(), response.by_any), 0.0);
}

}  // namespace
}  // namespace turnlight::estimator::uncertainty
