// Proves, on random surface points whose radiances are the scene model's own: the solver finds the
// scene from a start some degrees off; what is at a bound ends there exactly, and what is held does
// not move; its limit of iterations, its history of costs and its bits are as it says; a start with
// far too many lights is no trap. Does not prove: that the model is right, or that a start is found
// (initial_guess, recovery_test).
#include "estimator/solve/solver.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/angles.h"
#include "base/parallel.h"
#include "estimator/model/direction_lattice.h"
#include "estimator/start/start_scene.h"
#include "estimator/uncertainty/reported.h"
#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::solve {
namespace {

using Eigen::Vector3d;

// Everything that is free is off: directions by so many degrees, the rest by tens of per cent.
model::Scene Off(model::Scene scene, double degrees) {
  for (model::Light& light : scene.lights) {
    light.direction = Turned(light.direction, degrees);
    light.inverse_distance = 0.05;
  }
  scene.lights[1].intensity *= 1.3;
  model::Reflectance& r = scene.reflectance;
  r.albedo.x() *= 0.8;
  r.ambient = 0.2;
  r.diffuse *= 1.2;
  r.lobes[0].strength *= 0.7;
  r.lobes[0].shape *= 0.6;
  return scene;
}

// Where nothing but rounding is left, a step may be too small to gain and too small to be seen.
bool AtTheMinimum(const Solution& solution) {
  return solution.stopped == Stopped::kTolerance || solution.stopped == Stopped::kNoDescent;
}

// From the truth's values in what the gauge holds.
TEST(Solver, RecoversANoiselessScene) {
  const model::Scene truth = TwoLights();
  const RandomObservations random(4000, 3, 1, &truth);
  for (const double degrees : {3.0, 10.0, 20.0}) {
    const Solution s = Solve(random.observations, Off(truth, degrees), {});
    EXPECT_TRUE(AtTheMinimum(s));
    for (std::size_t l = 0; l < 2; ++l) {
      const model::Light &found = s.scene.lights[l], &light = truth.lights[l];
      EXPECT_LT((found.direction - light.direction).norm(), 1e-5) << degrees;
      EXPECT_NEAR(found.inverse_distance, light.inverse_distance, 1e-5) << degrees;
      EXPECT_NEAR(found.intensity, light.intensity, 1e-5) << degrees;
    }
    const model::Reflectance &r = s.scene.reflectance, &t = truth.reflectance;
    EXPECT_LT((r.albedo - t.albedo).norm(), 1e-5) << degrees;
    EXPECT_NEAR(r.ambient, t.ambient, 1e-5) << degrees;
    EXPECT_NEAR(r.diffuse, t.diffuse, 1e-5) << degrees;
    EXPECT_NEAR(r.lobes[0].strength, t.lobes[0].strength, 1e-5) << degrees;
    EXPECT_NEAR(r.lobes[0].shape, t.lobes[0].shape, 1e-3) << degrees;
  }
}

TEST(Solver, EndsAtABoundWhereTheTruthIs) {
  model::Scene truth = TwoLights();
  truth.reflectance.ambient = 0.0;
  truth.lights[0].inverse_distance = 0.0;
  const RandomObservations random(4000, 3, 2, &truth);
  const Solution s = Solve(random.observations, Off(truth, 5.0), {});
  EXPECT_TRUE(AtTheMinimum(s));
  EXPECT_GE(s.scene.reflectance.ambient, 0.0);
  EXPECT_LT(s.scene.reflectance.ambient, 1e-5);
  EXPECT_GE(s.scene.lights[0].inverse_distance, 0.0);
  EXPECT_LT(s.scene.lights[0].inverse_distance, 1e-5);
  EXPECT_NEAR(s.scene.lights[1].inverse_distance, 0.25, 1e-5);
}

// Pictures of a light from "beyond infinity", whose rays converge, and of an ambient light below 0:
// the best that is allowed is the bound, to the last bit, and the cost would fall beyond it.
TEST(Solver, EndsExactlyAtABoundWhereTheTruthIsBeyond) {
  model::Scene truth = TwoLights();
  truth.reflectance.ambient = -0.05;
  truth.lights[0].inverse_distance = -0.05;
  const RandomObservations random(4000, 3, 3, &truth);
  const Solution s = Solve(random.observations, Off(TwoLights(), 5.0), {});
  EXPECT_EQ(s.stopped, Stopped::kTolerance);
  EXPECT_EQ(s.scene.reflectance.ambient, 0.0);
  EXPECT_EQ(s.scene.lights[0].inverse_distance, 0.0);
  const model::Parameters parameters = PlainParameters(3, 2);
  EXPECT_GT(s.equations.gradient[parameters.Ambient()], 0.0);
  EXPECT_GT(s.equations.gradient[parameters.InverseDistance(0)], 0.0);
  EXPECT_FALSE(s.held[static_cast<std::size_t>(parameters.Ambient())]);
}

TEST(Solver, GaugeIsHeld) {
  const model::Scene truth = TwoLights();
  const RandomObservations random(2000, 3, 4, &truth);
  const model::Parameters parameters = PlainParameters(3, 2);
  model::Scene start = Off(truth, 5.0);
  start.lights[0].intensity = 2.0;
  start.reflectance.albedo = {0.3, 0.3, 1.1};
  SolveOptions options;
  const Solution strongest = Solve(random.observations, start, options);
  EXPECT_EQ(strongest.scene.lights[0].intensity, 2.0);
  EXPECT_EQ(strongest.scene.reflectance.albedo[2], 1.1);
  EXPECT_NE(strongest.scene.reflectance.diffuse, start.reflectance.diffuse);
  options.gauge = Gauge::kDiffuse;
  const Solution diffuse = Solve(random.observations, start, options);
  EXPECT_EQ(diffuse.scene.reflectance.diffuse, start.reflectance.diffuse);
  EXPECT_NE(diffuse.scene.lights[0].intensity, 2.0);
  for (int column = 0; column < parameters.count(); ++column) {
    const auto at = static_cast<std::size_t>(column);
    const bool never = column == parameters.Albedo(2) || column == parameters.Roughness();
    EXPECT_EQ(strongest.held[at], never || column == parameters.Intensity(0)) << column;
    EXPECT_EQ(diffuse.held[at], never || column == parameters.Diffuse()) << column;
  }
  // Either way the same scene.
  const auto reported = [&](const model::Scene& scene) {
    return uncertainty::Report(scene, random.observations,
                               uncertainty::StrengthOrder(scene, random.observations));
  };
  const uncertainty::Reported a = reported(strongest.scene), b = reported(diffuse.scene);
  EXPECT_NEAR(a.reflectance.diffuse, b.reflectance.diffuse, 1e-5);
  EXPECT_NEAR(a.lights[1].light.intensity, b.lights[1].light.intensity, 1e-5);
}

TEST(Solver, HeldDistancesDirectionsAndLobeDoNotMove) {
  const model::Scene truth = TwoLights();
  const RandomObservations random(2000, 3, 5, &truth);
  SolveOptions options;
  options.fixed_distance = {true, false};
  model::Scene start = Off(truth, 5.0);
  start.lights[0].inverse_distance = 0.11;
  Solution s = Solve(random.observations, start, options);
  EXPECT_EQ(s.scene.lights[0].inverse_distance, 0.11);
  EXPECT_NE(s.scene.lights[1].inverse_distance, start.lights[1].inverse_distance);

  options.free_directions = false;
  start.reflectance.lobes[0].model = model::SpecularModel::kNone;
  start.reflectance.roughness = 0.3;  // of a model that is not in use
  s = Solve(random.observations, start, options);
  EXPECT_LT(s.cost_history.back(), s.cost_history.front());
  for (std::size_t l = 0; l < 2; ++l)
    EXPECT_LT((s.scene.lights[l].direction - start.lights[l].direction).norm(), 1e-14);
  EXPECT_EQ(s.scene.reflectance.lobes[0].strength, start.reflectance.lobes[0].strength);
  EXPECT_EQ(s.scene.reflectance.lobes[0].shape, start.reflectance.lobes[0].shape);
  EXPECT_EQ(s.scene.reflectance.roughness, 0.3);
}

TEST(Solver, TheColoursOfWhiteLightsAreHeldElseTheStrongestLights) {
  model::Scene truth = TwoLights();
  truth.lights.push_back({Eigen::Vector3d(0.1, -0.9, 0.4).normalized(), 0.1, 0.3, {1.0, 0.8, 0.6}});
  const RandomObservations random(2000, 3, 5, &truth);
  model::Scene start = Off(truth, 2.0);
  start.lights[2].color = Eigen::Vector3d::Ones();
  start.free_colours = true;
  // Of the third nothing is said.
  for (const std::vector<bool>& white : {std::vector<bool>{}, {true, true}}) {
    SolveOptions options;
    options.white = white;
    const Solution s = Solve(random.observations, start, options);
    EXPECT_EQ(s.scene.lights[0].color, start.lights[0].color);
    EXPECT_EQ(s.scene.lights[1].color == start.lights[1].color, !white.empty());
    EXPECT_LT((s.scene.lights[2].color - truth.lights[2].color).norm(), 0.01);
  }
}

TEST(Solver, StopsAtItsLimit) {
  const model::Scene truth = TwoLights();
  const RandomObservations random(2000, 3, 6, &truth);
  for (const int most : {0, 1, 3}) {
    SolveOptions options;
    options.max_iterations = most;
    const Solution s = Solve(random.observations, Off(truth, 15.0), options);
    EXPECT_EQ(s.iterations, most);
    EXPECT_EQ(s.stopped, Stopped::kIterationLimit);
    EXPECT_EQ(s.cost_history.size(), static_cast<std::size_t>(most) + 1);
  }
}

TEST(Solver, CostNeverRises) {
  for (std::uint64_t seed = 10; seed < 16; ++seed) {
    const model::Scene truth = TwoLights();
    RandomObservations random(2000, 3, seed, &truth);
    AddNoise(0.02, seed, random.observations);
    const Solution s = Solve(random.observations, Off(truth, 25.0), {});
    ASSERT_EQ(s.cost_history.size(), static_cast<std::size_t>(s.iterations) + 1);
    for (std::size_t i = 1; i < s.cost_history.size(); ++i)
      EXPECT_LE(s.cost_history[i], s.cost_history[i - 1]) << seed;
    EXPECT_EQ(s.cost_history.back(), s.equations.cost);
    EXPECT_EQ(s.cost_history.back(), Evaluate(random.observations, s.scene, {}).cost);
  }
}

// 22 of 24 lights must go dark while the others move by tens of degrees: steps that are cut short
// at each bound that they meet come to a halt far from the minimum.
TEST(Solver, LightsToSpareAreNoTrap) {
  const model::Scene truth = TwoLights();
  const RandomObservations random(3000, 3, 7, &truth);
  const model::Scene start = start::StartFromDirections(
      random.observations, model::HemisphereDirections(24, Vector3d::UnitZ()));
  SolveOptions options;
  options.gauge = Gauge::kDiffuse;
  const Solution s = Solve(random.observations, start, options);
  EXPECT_LT(s.cost_history.back(), 1e-9 * s.cost_history.front());
  std::vector<model::Light> bright;
  for (const model::Light& light : s.scene.lights)
    if (light.intensity > 1e-5) bright.push_back(light);
  ASSERT_EQ(bright.size(), 2u);
  for (const model::Light& light : truth.lights) {
    const bool first = bright[0].direction.dot(light.direction) > 0.9;
    EXPECT_LT((bright[first ? 0 : 1].direction - light.direction).norm(), 1e-4);
  }
}

TEST(Solver, SameBitsForAnyNumberOfThreads) {
  const model::Scene truth = TwoLights();
  const RandomObservations random(30000, 3, 8, &truth);
  SetThreads(1);
  const Solution one = Solve(random.observations, Off(truth, 10.0), {});
  SetThreads(2);
  const Solution two = Solve(random.observations, Off(truth, 10.0), {});
  SetThreads(0);
  EXPECT_EQ(one.cost_history, two.cost_history);
  EXPECT_TRUE(one.equations.hessian == two.equations.hessian);
  for (std::size_t l = 0; l < 2; ++l)
    EXPECT_TRUE(one.scene.lights[l].direction == two.scene.lights[l].direction);
  EXPECT_EQ(one.scene.reflectance.lobes[0].shape, two.scene.reflectance.lobes[0].shape);
}

TEST(Solver, AStopFlagEndsItBeforeTheNextIteration) {
  const model::Scene truth = TwoLights();
  const RandomObservations random(2000, 3, 5, &truth);
  StopFlag stop{true};
  SolveOptions options;
  options.stop = &stop;
  const model::Scene start = Off(truth, 5.0);
  const Solution s = Solve(random.observations, start, options);
  EXPECT_EQ(s.iterations, 0);
  EXPECT_EQ(s.scene.lights[0].direction, start.lights[0].direction);
  stop = false;
  EXPECT_GT(Solve(random.observations, start, options).iterations, 0);
}

}  // namespace
}  // namespace turnlight::estimator::solve
