// Proves, on a scene's own radiances with noise: lights are found from the map's clusters and
// without any, with the diffuse model and the lobe that they are seen on; each decision is a rung
// with its numbers, and what the user chose is not decided. Does not prove it at large:
// bench/studies does.
#include "estimator/start/find_lights.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

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

// Of what is explained, and of what no model at hand explains: a fifth more light on one side.
TEST(FindLights, TheOrderOfTheStartsIsNothing) {
  for (const bool explained : {true, false}) {
    model::Scene truth = TwoLights();
    truth.lights.push_back(ThirdLight());
    Sample sample = NoisySample(truth);
    if (!explained)
      for (std::size_t i = 0; i < sample.pixels.size(); ++i)
        for (auto& channel : sample.pixels.radiance)
          if (!channel.empty() && sample.pixels.normal[0][i] > 0.2f) channel[i] *= 1.2f;
    std::vector<observe::MapPoint> clusters = ClustersOf(sample);
    ASSERT_GE(clusters.size(), 2u);
    std::vector<model::Rung> ladder;
    const Candidate first = FindLights(sample, clusters, ladder);
    std::mt19937 random(3);
    for (int order = 0; order < 4; ++order) {
      std::shuffle(clusters.begin(), clusters.end(), random);
      const Candidate again = FindLights(sample, clusters, ladder);
      ASSERT_EQ(again.scene.lights.size(), first.scene.lights.size()) << explained;
      // Of what is not explained the fits on the sample end where others differ by factors.
      EXPECT_LT(WorstDirectionDeg(again.scene.lights, first.scene.lights), explained ? 0.01 : 0.5);
      EXPECT_NEAR(again.excess / first.excess, 1.0, 0.01);
    }
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

struct SurfaceModel {
  model::SpecularModel lobe;
  model::DiffuseModel diffuse;
};

class ChooseLobeAndCoatTest : public testing::TestWithParam<SurfaceModel> {};

TEST_P(ChooseLobeAndCoatTest, IsThatOfTheScene) {
  model::Scene truth = TwoLights();
  model::Reflectance& r = truth.reflectance;
  r.lobes[0] = model::Converted(r.lobes[0], GetParam().lobe);
  r.diffuse_model = GetParam().diffuse;
  const Sample sample = NoisySample(truth);
  const Candidate fitted = FitStart(sample, TwoLights());
  std::vector<model::Rung> ladder;
  const Candidate chosen = ChooseLobeAndCoat(sample, fitted, ladder);
  const model::Reflectance& found = chosen.scene.reflectance;
  EXPECT_EQ(found.lobes[0].model, GetParam().lobe);
  EXPECT_EQ(found.diffuse_model, GetParam().diffuse);
  EXPECT_NEAR(found.lobes[0].shape / r.lobes[0].shape, 1.0, 0.06);
  const bool plain = GetParam().lobe == model::SpecularModel::kPhong &&
                     GetParam().diffuse == model::DiffuseModel::kLambert;
  EXPECT_EQ(ladder.size(), plain ? 1u : 4u);
  for (const model::Rung& rung : ladder)
    EXPECT_EQ(rung.accepted, rung.rung == FactsOf(GetParam().lobe).word ||
                                 rung.rung == FactsOf(GetParam().diffuse).word)
        << rung.rung << ": " << rung.why;
}

INSTANTIATE_TEST_SUITE_P(
    Surfaces, ChooseLobeAndCoatTest,
    testing::Values(SurfaceModel{model::SpecularModel::kPhong, model::DiffuseModel::kLambert},
                    SurfaceModel{model::SpecularModel::kPhong, model::DiffuseModel::kCoated},
                    SurfaceModel{model::SpecularModel::kBlinnPhong, model::DiffuseModel::kLambert},
                    SurfaceModel{model::SpecularModel::kBeckmann, model::DiffuseModel::kLambert},
                    SurfaceModel{model::SpecularModel::kGgx, model::DiffuseModel::kLambert},
                    SurfaceModel{model::SpecularModel::kGgx, model::DiffuseModel::kCoated}));

TEST(ChooseLobeAndCoat, WhatIsFixedIsKeptAndTheOtherIsDecided) {
  model::Scene truth = TwoLights();
  truth.reflectance.lobes[0] =
      model::Converted(truth.reflectance.lobes[0], model::SpecularModel::kGgx);
  truth.reflectance.diffuse_model = model::DiffuseModel::kCoated;
  const auto rung_of = [](const std::vector<model::Rung>& ladder, const std::string& name) {
    for (const model::Rung& rung : ladder)
      if (rung.rung == name) return rung;
    return model::Rung{"none", false, ""};
  };
  Sample sample = NoisySample(truth);
  sample.choice.specular = model::SpecularModel::kGgx;
  model::Scene start = truth;
  start.reflectance.diffuse_model = model::DiffuseModel::kLambert;
  std::vector<model::Rung> ladder;
  Candidate chosen = ChooseLobeAndCoat(sample, FitStart(sample, start), ladder);
  EXPECT_EQ(chosen.scene.reflectance.diffuse_model, model::DiffuseModel::kCoated);
  EXPECT_EQ(rung_of(ladder, "ggx").why, "as asked for");
  EXPECT_TRUE(rung_of(ladder, "coated").accepted);
  EXPECT_THAT(rung_of(ladder, "coated").why, HasSubstr("without a coat"));

  sample.choice.specular.reset();
  sample.choice.diffuse = model::DiffuseModel::kCoated;
  start.reflectance = TwoLights().reflectance;
  start.reflectance.diffuse_model = model::DiffuseModel::kCoated;
  ladder.clear();
  chosen = ChooseLobeAndCoat(sample, FitStart(sample, start), ladder);
  EXPECT_EQ(chosen.scene.reflectance.lobes[0].model, model::SpecularModel::kGgx);
  EXPECT_EQ(chosen.scene.reflectance.diffuse_model, model::DiffuseModel::kCoated);
  EXPECT_EQ(rung_of(ladder, "coated").why, "as asked for");
  EXPECT_TRUE(rung_of(ladder, "ggx").accepted);
}

TEST(FindLights, OfTheirOwnColours) {
  for (const bool coloured : {false, true}) {
    model::Scene truth = TwoLights();
    if (coloured) truth.lights[1].color = {0.3, 0.6, 1.0};
    const Sample sample = NoisySample(truth);
    std::vector<model::Rung> ladder;
    const Candidate found = FindLights(sample, ClustersOf(sample), ladder);
    EXPECT_EQ(found.scene.free_colours, coloured);
    ASSERT_EQ(found.scene.lights.size(), 2u);
    EXPECT_LT(WorstDirectionDeg(found.scene.lights, truth.lights), 0.5);
    if (!coloured) continue;
    // Of the weaker one, in the colour of the stronger.
    const auto& lights = found.scene.lights;
    const bool first = model::Strength(lights[0]) > model::Strength(lights[1]);
    const Eigen::Vector3d colour =
        lights[first ? 1 : 0].color.cwiseQuotient(lights[first ? 0 : 1].color);
    EXPECT_LT((colour / colour.maxCoeff() - truth.lights[1].color).norm(), 0.02);
  }
}

TEST(ChooseDiffuse, WhatTheUserChoseIsNotDecided) {
  Sample sample = NoisySample(RoughTwoLights());
  sample.choice.diffuse = model::DiffuseModel::kLambert;
  sample.choice.specular = model::SpecularModel::kPhong;
  const Candidate fitted = FitStart(sample, TwoLights());
  std::vector<model::Rung> ladder;
  const Candidate same = ChooseLobeAndCoat(sample, ChooseDiffuse(sample, fitted, ladder), ladder);
  EXPECT_EQ(same.rms_history, fitted.rms_history);
  ASSERT_EQ(ladder.size(), 2u);
  for (const model::Rung& rung : ladder) EXPECT_EQ(rung.why, "as asked for");
}

}  // namespace
}  // namespace turnlight::estimator::start
