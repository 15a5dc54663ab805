// Proves, on a scene's own radiances with noise: a highlight, a distance and a robust loss are
// taken where the data call for them and left where they do not, each as a rung with its numbers;
// what the user chose is not decided. Does not prove the thresholds, nor anything on pictures
// (model_choice_test, recovery_test, bench/studies).
#include "estimator/select/model_selection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::select {
namespace {

constexpr double kValueNoise = 0.003;

observe::Observations NoisyPicture(const model::Scene& truth, std::uint64_t seed = 1) {
  observe::Observations all = RandomObservations(6000, 3, seed, &truth).observations;
  AddNoise(kValueNoise, seed, all);
  return all;
}

struct Selected {
  std::vector<model::Rung> ladder;  // before what fills it
  Refined refined;

  Selected(const observe::Observations& all, const model::Scene& start,
           const model::ModelChoice& choice = {})
      : refined(Refine(all, start, kValueNoise, 1.0, choice, ladder)) {}
  bool Accepted(const std::string& rung) const {
    for (const model::Rung& each : ladder)
      if (each.rung == rung) return each.accepted;
    ADD_FAILURE() << "no rung " << rung;
    return false;
  }
};

TEST(Refine, ANearLightIsNearAndADistantOneIsHeldThere) {
  const model::Scene truth = TwoLights(0.0, 0.25);
  const Selected selected(NoisyPicture(truth), truth);
  EXPECT_EQ(selected.refined.near, (std::vector<bool>{false, true}));
  EXPECT_FALSE(selected.Accepted("near light 1"));
  EXPECT_TRUE(selected.Accepted("near light 2"));
  EXPECT_EQ(selected.refined.solution.scene.lights[0].inverse_distance, 0.0);
  EXPECT_NEAR(selected.refined.solution.scene.lights[1].inverse_distance, 0.25, 0.01);
  EXPECT_NEAR(selected.refined.inverse_distance[0], 0.0,
              4.0 * selected.refined.inverse_distance_sigma[0]);
  EXPECT_TRUE(selected.Accepted("specular"));
  EXPECT_FALSE(selected.Accepted("robust-loss"));
  EXPECT_EQ(selected.refined.options.evaluate.huber, 0.0);
  EXPECT_EQ(selected.refined.cost_history.size(),
            static_cast<std::size_t>(selected.refined.iterations) + 1);
}

TEST(Refine, ColoursThatAreNotThereAreTakenOut) {
  for (const bool coloured : {false, true}) {
    model::Scene truth = TwoLights();
    if (coloured) truth.lights[1].color = {1.0, 0.9, 0.7};
    model::Scene start = truth;
    start.free_colours = true;
    const Selected selected(NoisyPicture(truth), start);
    const model::Scene& found = selected.refined.solution.scene;
    EXPECT_EQ(selected.Accepted("colour of light 2"), coloured);
    EXPECT_EQ(found.free_colours, coloured);
    EXPECT_EQ(found.coloured(), coloured);
    EXPECT_LT((found.lights[1].color - truth.lights[1].color).norm(), 0.02);
  }
}

model::Scene GlossyOfF0(double f0) {
  model::Scene scene = TwoLights();
  scene.reflectance.lobes[0] = {model::SpecularModel::kGgx, f0 < 1.0 ? 1.0 : 0.2, 0.25, f0};
  return scene;
}

// Of light and viewer near each other F is F0: only views at grazing angles tell it from 1.
TEST(Refine, F0IsHeldUnlessTheViewsTellIt) {
  for (const double f0 : {0.1, 1.0}) {
    const model::Scene truth = GlossyOfF0(f0);
    model::Scene start = truth;
    start.reflectance.lobes[0].f0 = 1.0;
    start.reflectance.lobes[0].strength *= f0;
    const Selected selected(NoisyPicture(truth), start);
    const model::Lobe& found = selected.refined.solution.scene.reflectance.lobes[0];
    EXPECT_EQ(selected.Accepted("fresnel"), f0 < 1.0);
    EXPECT_NEAR(found.f0, f0, 0.1);
    EXPECT_NEAR(found.shape, 0.25, 0.01);
  }
}

// The start's F0, as a user may give it, is gone on from, or is 1 again.
TEST(Refine, AnF0OfTheStartIsNoDecision) {
  for (const double f0 : {0.1, 1.0}) {
    const model::Scene truth = GlossyOfF0(f0);
    model::Scene start = truth;
    start.reflectance.lobes[0].f0 = 0.2;
    start.reflectance.lobes[0].strength *= f0 / 0.2;
    const Selected selected(NoisyPicture(truth), start);
    const model::Lobe& found = selected.refined.solution.scene.reflectance.lobes[0];
    EXPECT_EQ(selected.Accepted("fresnel"), f0 < 1.0);
    EXPECT_NEAR(found.f0, f0, 0.1);
    EXPECT_NEAR(found.strength * found.f0, truth.reflectance.lobes[0].strength * f0, 0.02);
  }
}

TEST(Refine, WithoutALightThereAreNoColours) {
  model::Scene truth = TwoLights();
  truth.lights.clear();
  truth.reflectance.ambient = 0.5;
  model::Scene start = truth;
  start.free_colours = true;
  start.reflectance.ambient_colour = {1.0, 0.5, 0.5};
  for (const bool asked : {false, true}) {
    model::ModelChoice choice;
    if (asked) choice.coloured = true;
    const Selected selected(NoisyPicture(truth), start, choice);
    const model::Scene& found = selected.refined.solution.scene;
    EXPECT_FALSE(found.free_colours);
    EXPECT_FALSE(found.coloured());
    EXPECT_LT((found.reflectance.ambient * found.reflectance.albedo -
               truth.reflectance.ambient * truth.reflectance.albedo)
                  .norm(),
              1e-3);
    if (asked) {
      EXPECT_FALSE(selected.Accepted("colours"));
      const auto rung =
          std::find_if(selected.ladder.begin(), selected.ladder.end(),
                       [](const model::Rung& each) { return each.rung == "colours"; });
      EXPECT_THAT(rung->why, testing::HasSubstr("there is no light"));
    }
  }
}

TEST(Refine, AHighlightThatIsNotThereIsTakenOut) {
  model::Scene truth = TwoLights();
  truth.reflectance.lobes[0].strength = 0.0;
  model::Scene start = truth;
  start.reflectance.lobes[0].strength = 0.1;
  const Selected selected(NoisyPicture(truth), start);
  EXPECT_FALSE(selected.Accepted("specular"));
  const model::Reflectance& r = selected.refined.solution.scene.reflectance;
  EXPECT_EQ(r.lobes[0].model, model::SpecularModel::kNone);
  EXPECT_EQ(r.lobes[0].strength, 0.0);
  EXPECT_GT(selected.refined.specular_sigma, 0.0);
  EXPECT_GE(selected.refined.specular_sigma, selected.refined.specular_sigma_stat);
  EXPECT_LT(WorstDirectionDeg(selected.refined.solution.scene.lights, truth.lights), 1.0);
}

// One pixel in ten is dirt.
TEST(Refine, OutliersMakeTheLossRobustAndMoveNoLight) {
  const model::Scene truth = TwoLights();
  observe::Observations all = NoisyPicture(truth);
  for (std::size_t i = 0; i < all.used; i += 10)
    for (int c = 0; c < 3; ++c) all.radiance[c][i] *= 0.5f;
  const Selected selected(all, truth);
  EXPECT_TRUE(selected.Accepted("robust-loss"));
  EXPECT_GT(selected.refined.options.evaluate.huber, 0.5 * kValueNoise);
  EXPECT_LT(selected.refined.options.evaluate.huber, 10.0 * kValueNoise);
  EXPECT_LT(WorstDirectionDeg(selected.refined.solution.scene.lights, truth.lights), 0.5);
}

TEST(Refine, WhatTheUserChoseIsNotDecided) {
  model::Scene truth = TwoLights(0.0, 0.25);
  truth.reflectance.lobes[0].strength = 0.0;
  model::Scene start = truth;
  start.reflectance.lobes[0].strength = 0.1;
  model::ModelChoice choice;
  choice.specular = model::SpecularModel::kPhong;
  choice.near = false;
  const Selected selected(NoisyPicture(truth), start, choice);
  EXPECT_TRUE(selected.Accepted("specular"));
  EXPECT_EQ(selected.refined.solution.scene.reflectance.lobes[0].model,
            model::SpecularModel::kPhong);
  EXPECT_EQ(selected.refined.near, (std::vector<bool>{false, false}));
  for (const model::Light& light : selected.refined.solution.scene.lights)
    EXPECT_EQ(light.inverse_distance, 0.0);
}

}  // namespace
}  // namespace turnlight::estimator::select
