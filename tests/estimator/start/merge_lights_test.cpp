// Proves: a light that a start has twice, or in two halves a few degrees apart, is one again with
// the strength of both; what is negligible goes; lights that are apart stay, and no more merge than
// asked for. Does not prove where the limit should be.
#include "estimator/start/merge_lights.h"

#include <gtest/gtest.h>

#include "tests/estimator/start/noisy_sample.h"

namespace turnlight::estimator::start {
namespace {

// The first light in two halves, so many degrees apart.
model::Scene FirstLightSplit(const model::Scene& truth, double degrees) {
  model::Scene split = truth;
  split.lights[0].intensity *= 0.5;
  split.lights.push_back(split.lights[0]);
  split.lights[2].direction = Turned(split.lights[0].direction, degrees);
  return split;
}

TEST(FitAndMerge, ASplitLightIsOneAgain) {
  const model::Scene truth = TwoLights();
  const Sample sample = NoisySample(truth);
  for (const double degrees : {0.0, 2.0, 5.0}) {
    const Candidate merged = FitAndMerge(sample, FirstLightSplit(truth, degrees));
    EXPECT_LT(WorstDirectionDeg(merged.scene.lights, truth.lights), 0.5) << degrees;
    EXPECT_TRUE(NothingLeft(merged.excess, sample));
    if (merged.scene.lights.size() == 2) {
      const double ratio = merged.scene.lights[0].intensity / merged.scene.lights[1].intensity;
      EXPECT_NEAR(ratio, 0.9 / 0.6, 0.05);
    }
  }
}

TEST(FitAndMerge, ASplitLightKeepsItsColour) {
  model::Scene truth = TwoLights();
  truth.lights[1].color = {0.3, 0.6, 1.0};
  truth.free_colours = true;
  const Sample sample = NoisySample(truth);
  const model::Scene merged = FitAndMerge(sample, FirstLightSplit(truth, 2.0)).scene;
  ASSERT_EQ(merged.lights.size(), 2u);
  const Eigen::Vector3d colour = merged.lights[1].color.cwiseQuotient(merged.lights[0].color);
  EXPECT_LT((colour / colour.maxCoeff() - truth.lights[1].color).norm(), 0.02);
}

TEST(FitAndMerge, LightsThatAreApartStay) {
  const model::Scene truth = TwoLights();
  const Sample sample = NoisySample(truth);
  EXPECT_LT(WorstDirectionDeg(FitAndMerge(sample, truth).scene.lights, truth.lights), 0.5);
}

TEST(FitAndMerge, TheNegligibleGoes) {
  const model::Scene truth = TwoLights();
  const Sample sample = NoisySample(truth);
  model::Scene more = truth;
  more.lights.push_back(ThirdLight(1e-4));
  EXPECT_LT(WorstDirectionDeg(FitAndMerge(sample, more).scene.lights, truth.lights), 0.5);
}

TEST(FitAndMerge, NotBelowTheNumberAskedFor) {
  const model::Scene truth = TwoLights();
  Sample sample = NoisySample(truth);
  sample.choice.lights = 3;
  EXPECT_EQ(FitAndMerge(sample, FirstLightSplit(truth, 1.0)).scene.lights.size(), 3u);
  // However little the ones to spare are worth.
  model::Scene more = truth;
  for (int spare = 0; spare < 3; ++spare) {
    more.lights.push_back(ThirdLight(1e-4));
    more.lights.back().direction = Turned(ThirdLight().direction, 40.0 * spare);
  }
  EXPECT_EQ(FitAndMerge(sample, more).scene.lights.size(), 3u);
}

}  // namespace
}  // namespace turnlight::estimator::start
