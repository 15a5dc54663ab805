// Proves, on random surface points with the scene model's own radiances and noise: a guess tens of
// degrees off leads to the true lights, what is given (lobes, F0, colours) is kept and what is
// absent is estimated, and the ladder says when the guess was of no use. Does not prove it on
// pictures of a target (recovery_test).
#include "estimator/start/fit_guess.h"

#include <gtest/gtest.h>

#include "tests/estimator/start/noisy_sample.h"

namespace turnlight::estimator::start {
namespace {

using Eigen::Vector3d;

// The same scene in W: here the coordinates of the observations are W's.
model::InitialGuess GuessOff(const model::Scene& truth, double degrees) {
  model::InitialGuess guess;
  for (const model::Light& light : truth.lights) {
    model::Light off = light;
    off.direction = Turned(light.direction, degrees);
    off.inverse_distance = 0.0;
    guess.lights.push_back(off);
  }
  return guess;
}

TEST(FitGuess, DirectionsTensOfDegreesOffLeadToTheLights) {
  const model::Scene truth = TwoLights();
  const Sample sample = NoisySample(truth);
  const auto clusters = ClustersOf(sample);
  for (const double degrees : {0.0, 10.0, 50.0}) {
    std::vector<model::Rung> ladder;
    const Candidate found = FitGuess(sample, GuessOff(truth, degrees), clusters, ladder);
    EXPECT_LT(WorstDirectionDeg(found.scene.lights, truth.lights), 0.5) << degrees;
    ASSERT_FALSE(ladder.empty());
    EXPECT_EQ(ladder.back().rung, "lights");
    EXPECT_EQ(ladder.back().why, "2, as given by --initial");
  }
}

// Both guesses at one place, on the far side: nothing that is near leads out of there.
TEST(FitGuess, BothAtOnePlaceLeadElsewhereAndTheLadderSaysSo) {
  const model::Scene truth = TwoLights();
  const Sample sample = NoisySample(truth);
  const auto clusters = ClustersOf(sample);
  model::InitialGuess guess;
  guess.lights.assign(2, {Vector3d(0.0, -0.2, -1.0).normalized(), 0.0, 1.0, Vector3d::Ones()});
  std::vector<model::Rung> ladder;
  const Candidate found = FitGuess(sample, guess, clusters, ladder);
  EXPECT_LT(WorstDirectionDeg(found.scene.lights, truth.lights), 0.5);
  ASSERT_EQ(ladder.size(), 2u);
  EXPECT_EQ(ladder[0].rung, "initial");
  EXPECT_FALSE(ladder[0].accepted) << ladder[0].why;
}

TEST(FitGuess, TheModelsGivenAreKept) {
  model::Scene truth = TwoLights();
  truth.reflectance.lobes[0].model = model::SpecularModel::kBlinnPhong;
  const Sample sample = NoisySample(truth);
  model::InitialGuess guess = GuessOff(truth, 5.0);
  guess.reflectance = truth.reflectance;
  std::vector<model::Rung> ladder;
  const Candidate found = FitGuess(sample, guess, {}, ladder);
  EXPECT_EQ(found.scene.reflectance.lobes[0].model, model::SpecularModel::kBlinnPhong);
  EXPECT_LT(WorstDirectionDeg(found.scene.lights, truth.lights), 0.5);
  EXPECT_NEAR(found.scene.reflectance.lobes[0].shape, 25.0, 1.0);
}

TEST(FitGuess, BothLobesAndF0AreTaken) {
  model::Scene truth = TwoLights();
  truth.reflectance.lobes = {model::Lobe{model::SpecularModel::kGgx, 0.2, 0.12, 0.3},
                             model::Lobe{model::SpecularModel::kPhong, 0.1, 6.0}};
  Sample sample = NoisySample(truth);
  model::InitialGuess guess = GuessOff(truth, 5.0);
  guess.reflectance = truth.reflectance;
  std::vector<model::Rung> ladder;
  const model::Reflectance found = FitGuess(sample, guess, {}, ladder).scene.reflectance;
  EXPECT_EQ(found.lobes[0].model, model::SpecularModel::kGgx);
  EXPECT_EQ(found.lobes[0].f0, 0.3);
  EXPECT_NEAR(found.lobes[0].shape, 0.12, 0.02);
  EXPECT_EQ(found.lobes[1].model, model::SpecularModel::kPhong);
  EXPECT_NEAR(found.lobes[1].shape, 6.0, 2.0);
  // Without a first there is no second.
  sample.choice.specular = model::SpecularModel::kNone;
  const Candidate matte = FitGuess(sample, guess, {}, ladder);
  for (const model::Lobe& lobe : matte.scene.reflectance.lobes) EXPECT_FALSE(lobe.present());
}

TEST(FitGuess, ColoursAreTakenUnlessTheUserSaysWhite) {
  model::Scene truth = TwoLights();
  truth.lights[1].color = {0.3, 0.6, 1.0};
  Sample sample = NoisySample(truth);
  model::InitialGuess guess = GuessOff(truth, 5.0);
  guess.lights[1].color = {1.0, 1.5, 2.0};  // the right order, and another scale
  std::vector<model::Rung> ladder;
  const model::Scene found = FitGuess(sample, guess, {}, ladder).scene;
  EXPECT_TRUE(found.free_colours);
  ASSERT_EQ(found.lights.size(), 2u);
  const Eigen::Vector3d colour = found.lights[1].color.cwiseQuotient(found.lights[0].color);
  EXPECT_LT((colour / colour.maxCoeff() - truth.lights[1].color).norm(), 0.02);
  sample.choice.coloured = false;
  EXPECT_FALSE(FitGuess(sample, guess, {}, ladder).scene.coloured());
  // A white guess of what is white is no reason for colours; the user's word is.
  Sample white = NoisySample(TwoLights());
  guess = GuessOff(TwoLights(), 5.0);
  EXPECT_FALSE(FitGuess(white, guess, {}, ladder).scene.free_colours);
  white.choice.coloured = true;
  EXPECT_TRUE(FitGuess(white, guess, {}, ladder).scene.free_colours);
}

}  // namespace
}  // namespace turnlight::estimator::start
