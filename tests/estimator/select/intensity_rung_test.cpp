// Proves, on a scene's own radiances with noise: lights that flicker by 5 %, or warm up by 10 %,
// are found to change, constant ones constant, in at least 19 of 20; what the user chose is not
// decided; pictures that all look alike to the model decide nothing. Does not prove that directions
// come out as without (recovery on pictures: changing_lights_test).
#include "estimator/select/intensity_rung.h"

#include <gtest/gtest.h>

#include "estimator/select/model_selection.h"
#include "tests/estimator/changing_lights.h"

namespace turnlight::estimator::select {
namespace {

constexpr double kNoise = 0.004;
constexpr std::size_t kKeyframes = 18;

bool FoundChanging(const observe::Observations& all, const model::Scene& start,
                   const model::ModelChoice& choice = {}) {
  std::vector<model::Rung> ladder;
  const Refined refined = Refine(all, start, kNoise, 1.0, choice, ladder);
  for (const model::Rung& rung : ladder)
    if (rung.rung == "changing-intensities") {
      EXPECT_EQ(rung.accepted, refined.solution.scene.flickers());
      return rung.accepted;
    }
  ADD_FAILURE() << "no such rung";
  return false;
}

TEST(ChooseIntensities, ChangingLightsAreFoundAndConstantOnesAreConstant) {
  int flickering = 0, warming = 0, constant = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const model::Scene start = TwoLights();
    flickering += FoundChanging(
        ChangingPictures(Changing(start, 0.05, kKeyframes, seed), kKeyframes, kNoise, seed), start);
    model::Scene lamp = Changing(start, 0.0, kKeyframes, seed);
    for (std::size_t k = 0; k < kKeyframes; ++k)
      lamp.lights[0].factors[k] = 0.95 + 0.1 * static_cast<double>(k) / (kKeyframes - 1);
    warming += FoundChanging(ChangingPictures(lamp, kKeyframes, kNoise, seed), start);
    constant += FoundChanging(
        ChangingPictures(Changing(start, 0.0, kKeyframes, seed), kKeyframes, kNoise, seed), start);
  }
  EXPECT_EQ(flickering, 20);
  EXPECT_EQ(warming, 20);
  EXPECT_LE(constant, 1);
}

TEST(ChooseIntensities, WhatIsAskedForIsDone) {
  const model::Scene truth = Changing(TwoLights(), 0.05, kKeyframes, 3);
  const observe::Observations all = ChangingPictures(truth, kKeyframes, kNoise);
  model::ModelChoice choice;
  choice.changing = false;
  EXPECT_FALSE(FoundChanging(all, TwoLights(), choice));
  // Also where nothing calls for them.
  choice.changing = true;
  EXPECT_TRUE(
      FoundChanging(ChangingPictures(Changing(TwoLights(), 0.0, kKeyframes, 3), kKeyframes, kNoise),
                    TwoLights(), choice));
}

TEST(ChooseIntensities, OneViewTellsNothing) {
  const observe::Observations all = ChangingPictures(Changing(TwoLights(), 0.0, 1, 3), 1, kNoise);
  std::vector<model::Rung> ladder;
  Refine(all, TwoLights(), kNoise, 1.0, {}, ladder);
  for (const model::Rung& rung : ladder) EXPECT_NE(rung.rung, "changing-intensities");
}

}  // namespace
}  // namespace turnlight::estimator::select
