// Proves, on a scene's own radiances with noise: lights are found from the map's clusters and
// without any, with the diffuse model and the lobe that they are seen on; each decision is a rung
// with its numbers, and what the user chose is not decided. Does not prove it at large:
// bench/studies does.
#include "estimator/start/find_lights.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/estimator/start/noisy_sample.h"

namespace turnlight::estimator::start {
namespace {

using testing::HasSubstr;

TEST(FindLights, FromClustersAndWithoutAny) {
  const model::Scene truth = TwoLights();
  const Sample sample = NoisySample(truth);
  for (const bool clusters : {true, false}) {
    std::vector<model::Rung> ladder;
    const Candidate found = FindLights(
        sample, clusters ? ClustersOf(sample) : std::vector<observe::MapPoint>(), ladder);
    EXPECT_LT(WorstDirectionDeg(found.scene.lights, truth.lights), 0.5);
    ASSERT_EQ(ladder.size(), 1u);
    EXPECT_EQ(ladder[0].rung, "start");
    EXPECT_THAT(ladder[0].why, HasSubstr("Taken: "));
  }
}

TEST(FindLights, ANumberAskedForIsSaidToBeReached) {
  Sample sample = NoisySample(TwoLights());
  sample.choice.lights = 2;
  std::vector<model::Rung> ladder;
  EXPECT_EQ(FindLights(sample, ClustersOf(sample), ladder).scene.lights.size(), 2u);
  ASSERT_EQ(ladder.size(), 2u);
  EXPECT_TRUE(ladder[1].accepted);
  EXPECT_EQ(ladder[1].why, "2 were asked for, 2 could be fitted");
}

model::Scene RoughTwoLights() {
  model::Scene rough = TwoLights();
  rough.reflectance.diffuse_model = model::DiffuseModel::kOrenNayar;
  rough.reflectance.roughness = 0.6;
  return rough;
}

TEST(ChooseDiffuse, IsThatOfTheScene) {
  for (const bool rough : {false, true}) {
    const Sample sample = NoisySample(rough ? RoughTwoLights() : TwoLights());
    // Begun with the other one.
    const Candidate fitted = FitStart(sample, rough ? TwoLights() : RoughTwoLights());
    std::vector<model::Rung> ladder;
    const Candidate chosen = ChooseDiffuse(sample, fitted, ladder);
    EXPECT_EQ(chosen.scene.reflectance.diffuse_model == model::DiffuseModel::kOrenNayar, rough);
    ASSERT_EQ(ladder.size(), 1u);
    EXPECT_EQ(ladder[0].rung, "oren-nayar");
    EXPECT_EQ(ladder[0].accepted, rough) << ladder[0].why;
    if (rough) {
      EXPECT_NEAR(chosen.scene.reflectance.roughness, 0.6, 0.03);
    }
  }
}

TEST(ChooseLobe, IsThatOfTheScene) {
  for (const bool half_vector : {false, true}) {
    model::Scene truth = TwoLights();
    if (half_vector) truth.reflectance.lobes[0].model = model::SpecularModel::kBlinnPhong;
    const Sample sample = NoisySample(truth);
    const Candidate fitted = FitStart(sample, TwoLights());
    std::vector<model::Rung> ladder;
    const Candidate chosen = ChooseLobe(sample, fitted, ladder);
    EXPECT_EQ(chosen.scene.reflectance.lobes[0].model, truth.reflectance.lobes[0].model);
    ASSERT_EQ(ladder.size(), 1u);
    EXPECT_EQ(ladder[0].accepted, half_vector) << ladder[0].why;
    EXPECT_NEAR(chosen.scene.reflectance.lobes[0].shape, 25.0, 1.5);
  }
}

TEST(ChooseDiffuse, WhatTheUserChoseIsNotDecided) {
  Sample sample = NoisySample(RoughTwoLights());
  sample.choice.diffuse = model::DiffuseModel::kLambert;
  sample.choice.specular = model::SpecularModel::kPhong;
  const Candidate fitted = FitStart(sample, TwoLights());
  std::vector<model::Rung> ladder;
  const Candidate same = ChooseLobe(sample, ChooseDiffuse(sample, fitted, ladder), ladder);
  EXPECT_EQ(same.rms_history, fitted.rms_history);
  ASSERT_EQ(ladder.size(), 2u);
  for (const model::Rung& rung : ladder) EXPECT_EQ(rung.why, "as asked for");
}

}  // namespace
}  // namespace turnlight::estimator::start
