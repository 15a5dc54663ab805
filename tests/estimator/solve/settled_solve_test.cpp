// Proves: a settled solve ends with the footprints and the shadows of where it ends, and with one
// round with those of where it began; its costs go on from round to round. Does not prove how many
// rounds real pictures need.
#include "estimator/solve/settled_solve.h"

#include <gtest/gtest.h>

#include "estimator/solve/footprints.h"
#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::solve {
namespace {

// A narrow lobe over footprints that it is narrower than, and a start that thinks it broad.
struct NarrowLobe {
  model::Scene truth = TwoLights(), start;
  observe::Observations pixels;

  NarrowLobe() {
    truth.reflectance.lobes[0].shape = 60.0;
    pixels = RandomObservations(3000, 3, 4, &truth).observations;
    pixels.tile_footprint.assign(pixels.tiles(), 0.08f);
    start = truth;
    start.reflectance.lobes[0].shape = 8.0;
    for (model::Light& light : start.lights) light.direction = Turned(light.direction, 2.0);
  }
};

TEST(SolveSettled, FootprintsAreThoseOfWhereItEnds) {
  const NarrowLobe it;
  const auto at_start = FootprintSamples(it.pixels, it.start.reflectance, 2);
  const auto at_end = FootprintSamples(it.pixels, it.truth.reflectance, 2);
  EXPECT_EQ(at_start[0], 2);
  const Solution once = SolveSettled(it.pixels, it.start, {}, 1);
  EXPECT_EQ(once.evaluate.samples_per_side, at_start);
  const Solution settled = SolveSettled(it.pixels, it.start, {}, 3);
  EXPECT_EQ(settled.evaluate.samples_per_side, at_end);
  EXPECT_NEAR(settled.scene.reflectance.lobes[0].shape, 60.0, 0.01);
  EXPECT_LT(WorstDirectionDeg(settled.scene.lights, it.truth.lights), 0.01);
}

TEST(SolveSettled, AnAttachedShadowsEdgeIsWhereTheLightsEnd) {
  NarrowLobe it;
  for (auto& component : it.pixels.footprint)
    std::fill(component.begin(), component.end(), observe::ToBFloat16(0.02f));
  it.pixels.tile_footprint.assign(it.pixels.tiles(), 0.0f);
  const Solution settled = SolveSettled(it.pixels, it.start, {}, 4);
  const Shadows at_end = CastShadows(it.pixels, settled.scene, settled.evaluate.shadows, 2e-4);
  EXPECT_TRUE(SameShadows(at_end, settled.evaluate.shadows));
  EXPECT_FALSE(SameShadows(CastShadows(it.pixels, it.start), settled.evaluate.shadows));
  EXPECT_GT(settled.evaluate.shadows.left_out, 0u);
}

TEST(SolveSettled, CostsAndIterationsAreOfAllRounds) {
  const NarrowLobe it;
  const Solution once = SolveSettled(it.pixels, it.start, {}, 1);
  const Solution settled = SolveSettled(it.pixels, it.start, {}, 3);
  EXPECT_GE(settled.iterations, once.iterations);
  EXPECT_EQ(settled.cost_history.size(), static_cast<std::size_t>(settled.iterations) + 1);
  for (std::size_t i = 0; i < once.cost_history.size(); ++i)
    EXPECT_EQ(settled.cost_history[i], once.cost_history[i]);
}

}  // namespace
}  // namespace turnlight::estimator::solve
