// Proves: from all pixels with noise a start is within a degree of the truth, with its ladder and
// history, by way of the map or of a guess; the same twice. Does not prove that it is good enough
// on pictures (recovery_test, unknown_errors_test).
#include "estimator/start/find_start.h"

#include <gtest/gtest.h>

#include "tests/estimator/start/noisy_sample.h"

namespace turnlight::estimator::start {
namespace {

TEST(FindStart, IsNearTheTruthWithAndWithoutAGuess) {
  const model::Scene truth = TwoLights();
  const observe::Observations all = [&] {
    observe::Observations out = RandomObservations(15000, 3, 1, &truth).observations;
    AddNoise(kSampleNoise, 1, out);
    return out;
  }();
  const observe::IntensityMap map = observe::MakeIntensityMap(all);
  const Start found = FindStart(all, kSampleNoise, map, std::nullopt, {});
  EXPECT_LT(WorstDirectionDeg(found.scene.lights, truth.lights), 1.0);
  EXPECT_GT(found.rms_history.size(), 2u);
  std::vector<std::string> rungs;
  for (const model::Rung& rung : found.ladder) rungs.push_back(rung.rung);
  EXPECT_EQ(rungs, (std::vector<std::string>{"start", "oren-nayar", "blinn-phong", "held-out light",
                                             "held-out light"}));
  EXPECT_EQ(FindStart(all, kSampleNoise, map, std::nullopt, {}).rms_history, found.rms_history);

  model::InitialGuess guess;
  guess.lights = truth.lights;
  for (model::Light& light : guess.lights) light.direction = Turned(light.direction, 5.0);
  const Start guessed = FindStart(all, kSampleNoise, map, guess, {});
  EXPECT_LT(WorstDirectionDeg(guessed.scene.lights, truth.lights), 1.0);
  ASSERT_EQ(guessed.ladder.size(), 1u);
  EXPECT_EQ(guessed.ladder[0].rung, "lights");
}

}  // namespace
}  // namespace turnlight::estimator::start
