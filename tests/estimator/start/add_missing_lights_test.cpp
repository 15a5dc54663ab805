// Proves: lights that a fit lacks are added, one or several at once; a fit that lacks none comes
// back as it was; a number that is asked for is reached, even if it does not help. Does not prove
// that every missing light can be found: bench/studies counts them.
#include "estimator/start/add_missing_lights.h"

#include <gtest/gtest.h>

#include "tests/estimator/start/noisy_sample.h"

namespace turnlight::estimator::start {
namespace {

TEST(AddMissingLights, FindsWhatTheFitLacks) {
  model::Scene truth = TwoLights();
  truth.lights.push_back(ThirdLight());
  const Sample sample = NoisySample(truth);
  for (const std::size_t known : {2u, 1u}) {
    model::Scene fewer = truth;
    fewer.lights.resize(known);
    const Candidate fitted = FitStart(sample, fewer);
    const Candidate all = AddMissingLights(sample, fitted);
    EXPECT_LT(WorstDirectionDeg(all.scene.lights, truth.lights), 1.0) << known;
    EXPECT_LT(all.excess, fitted.excess / 3.0);
    EXPECT_GT(all.rms_history.size(), fitted.rms_history.size());
  }
}

TEST(AddMissingLights, WhatLacksNothingStaysAsItIs) {
  const model::Scene truth = TwoLights();
  const Sample sample = NoisySample(truth);
  const Candidate fitted = FitStart(sample, truth);
  const Candidate same = AddMissingLights(sample, fitted);
  EXPECT_EQ(same.rms_history, fitted.rms_history);
  EXPECT_EQ(same.scene.lights[0].direction, fitted.scene.lights[0].direction);
}

TEST(AddMissingLights, GoesOnToTheNumberAskedFor) {
  const model::Scene truth = TwoLights();
  Sample sample = NoisySample(truth);
  sample.choice.lights = 3;
  EXPECT_EQ(AddMissingLights(sample, FitStart(sample, truth)).scene.lights.size(), 3u);
}

}  // namespace
}  // namespace turnlight::estimator::start
