// Proves, on a scene's own radiances with noise: a sharp and a broad lobe together are found with
// their widths, one alone stays one, what the user chose is not decided. Does not prove that real
// surfaces have two.
#include "estimator/start/second_lobe.h"

#include <gtest/gtest.h>

#include "tests/estimator/start/noisy_sample.h"

namespace turnlight::estimator::start {
namespace {

model::Scene TwoLobes(model::SpecularModel model) {
  model::Scene scene = TwoLights();
  model::Lobe& first = scene.reflectance.lobes[0];
  first = model::Converted({model::SpecularModel::kPhong, 0.3, 150.0}, model);
  scene.reflectance.lobes[1] = model::OfWidth(first, 4.0);
  scene.reflectance.lobes[1].strength *= 0.4;
  return scene;
}

// As the choice of one lobe leaves it.
Candidate OneLobe(const Sample& sample, model::Scene scene) {
  scene.reflectance.lobes[1] = model::Lobe{};
  return FitStart(sample, scene);
}

TEST(ChooseSecondLobe, ASharpAndABroadOneAreFound) {
  for (const auto model : {model::SpecularModel::kPhong, model::SpecularModel::kGgx}) {
    const model::Scene truth = TwoLobes(model);
    const Sample sample = NoisySample(truth);
    std::vector<model::Rung> ladder;
    const Candidate found = ChooseSecondLobe(sample, OneLobe(sample, truth), ladder);
    ASSERT_EQ(ladder.size(), 1u);
    EXPECT_TRUE(ladder[0].accepted) << ladder[0].why;
    for (std::size_t k = 0; k < 2; ++k) {
      const model::Lobe &lobe = found.scene.reflectance.lobes[k],
                        &known = truth.reflectance.lobes[k];
      EXPECT_NEAR(model::LobeHalfWidth(lobe), model::LobeHalfWidth(known),
                  0.1 * model::LobeHalfWidth(known));
      EXPECT_NEAR(model::LobePeak(lobe), model::LobePeak(known), 0.1 * model::LobePeak(known));
    }
    EXPECT_LT(WorstDirectionDeg(found.scene.lights, truth.lights), 0.3);
  }
}

TEST(ChooseSecondLobe, OneAloneStaysOne) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Sample sample = NoisySample(TwoLights(), seed);
    sample.noise *= 0.5;  // something is left to explain
    std::vector<model::Rung> ladder;
    const Candidate found = ChooseSecondLobe(sample, OneLobe(sample, TwoLights()), ladder);
    EXPECT_FALSE(found.scene.reflectance.lobes[1].present());
    ASSERT_EQ(ladder.size(), 1u);
    EXPECT_FALSE(ladder[0].accepted);
  }
}

TEST(ChooseSecondLobe, WhatIsAskedForIsDone) {
  Sample sample = NoisySample(TwoLobes(model::SpecularModel::kPhong));
  const Candidate one = OneLobe(sample, TwoLights());
  const auto lobes = [&] {
    std::vector<model::Rung> ladder;
    const Candidate found = ChooseSecondLobe(sample, one, ladder);
    return found.scene.reflectance.lobes[1].present() ? 2 : 1;
  };
  sample.choice.lobes = 1;
  EXPECT_EQ(lobes(), 1);
  sample.choice.lobes = 2;
  EXPECT_EQ(lobes(), 2);
  sample.choice = {};
  sample.choice.specular = model::SpecularModel::kPhong;
  EXPECT_EQ(lobes(), 1);
  sample.choice.lobes = 2;
  EXPECT_EQ(lobes(), 2);
}

}  // namespace
}  // namespace turnlight::estimator::start
