// Proves, on random surface points with the scene model's own radiances and noise: the held-out
// check removes a light that is not there, however strong the candidate says it is, and no true
// one; a guess tens of degrees off leads to the true lights, and what is given and absent is kept
// and estimated. Does not prove: either on pictures of a target (recovery_test).
#include "estimator/start/held_out.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/angles.h"
#include "estimator/model/initial_guess.h"
#include "estimator/observe/intensity_map.h"
#include "estimator/solve/normal_equations.h"
#include "estimator/start/fit_guess.h"
#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::start {
namespace {

using Eigen::Vector3d;

constexpr double kNoise = 0.003;

model::Light Absent() {
  return {Vector3d(0.1, -0.9, 0.4).normalized(), 0.1, 0.3, Vector3d::Ones()};
}

observe::Observations Noisy(const model::Scene& truth, std::uint64_t seed) {
  observe::Observations out = RandomObservations(4000, 3, seed, &truth).observations;
  const RandomStream noise(seed, 11);
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < out.used; ++i)
      out.radiance[c][i] += static_cast<float>(kNoise * noise.Normal(3 * i + c));
  out.subsampled = true;
  return out;
}

struct Setting {
  Sample sample;
  observe::Observations held_out;
};

Setting Set(const model::Scene& truth) { return {{Noisy(truth, 1), kNoise, {}}, Noisy(truth, 2)}; }

// Degrees; 180 if the numbers of lights differ.
double WorstDirection(const model::Scene& scene, const model::Scene& truth) {
  if (scene.lights.size() != truth.lights.size()) return 180.0;
  double worst = 0.0;
  for (const model::Light& light : truth.lights) {
    double nearest = 180.0;
    for (const model::Light& found : scene.lights)
      nearest = std::min(nearest,
                         RadToDeg(std::acos(std::min(1.0, found.direction.dot(light.direction)))));
    worst = std::max(worst, nearest);
  }
  return worst;
}

TEST(HeldOut, TrueLightsStay) {
  const model::Scene truth = TwoLights();
  const Setting set = Set(truth);
  std::vector<model::Rung> ladder;
  const Candidate fitted = FitStart(set.sample, truth);
  const Candidate checked = CheckHeldOut(set.held_out, set.sample, fitted, ladder);
  EXPECT_LT(WorstDirection(checked.scene, truth), 0.5);
  ASSERT_EQ(ladder.size(), 2u);
  for (const model::Rung& rung : ladder) {
    EXPECT_EQ(rung.rung, "held-out light");
    EXPECT_TRUE(rung.accepted) << rung.why;
  }
}

TEST(HeldOut, ALightThatIsNotThereGoes) {
  const model::Scene truth = TwoLights();
  const Setting set = Set(truth);
  model::Scene more = truth;
  more.lights.push_back(Absent());
  Candidate as_said;
  as_said.scene = more;
  for (const Candidate& candidate : {as_said, FitStart(set.sample, more)}) {
    ASSERT_EQ(candidate.scene.lights.size(), 3u);
    std::vector<model::Rung> ladder;
    const Candidate checked = CheckHeldOut(set.held_out, set.sample, candidate, ladder);
    EXPECT_LT(WorstDirection(checked.scene, truth), 0.5);
    ASSERT_EQ(ladder.size(), 3u);
    EXPECT_TRUE(ladder[0].accepted) << ladder[0].why;
    EXPECT_TRUE(ladder[1].accepted) << ladder[1].why;
    EXPECT_FALSE(ladder[2].accepted) << ladder[2].why;
    EXPECT_NE(ladder[2].why.find("(+0.10, -0.91, +0.40)"), std::string::npos) << ladder[2].why;
  }
}

// Asked for three lights there are three, and the ladder says what one of them is worth.
TEST(HeldOut, ANumberOfLightsAskedForIsKept) {
  const model::Scene truth = TwoLights();
  Setting set = Set(truth);
  set.sample.choice.lights = 3;
  Candidate candidate;
  candidate.scene = truth;
  candidate.scene.lights.push_back(Absent());
  std::vector<model::Rung> ladder;
  const Candidate checked = CheckHeldOut(set.held_out, set.sample, candidate, ladder);
  EXPECT_EQ(checked.scene.lights.size(), 3u);
  ASSERT_EQ(ladder.size(), 3u);
  EXPECT_FALSE(ladder[2].accepted);
}

// The same scene in W: here the coordinates of the observations are W's.
model::InitialGuess GuessOff(const model::Scene& truth, double degrees) {
  model::InitialGuess guess;
  for (const model::Light& light : truth.lights) {
    model::Light off = light;
    off.direction =
        (light.direction + std::tan(DegToRad(degrees)) * light.direction.unitOrthogonal())
            .normalized();
    off.inverse_distance = 0.0;
    guess.lights.push_back(off);
  }
  return guess;
}

TEST(FitGuess, DirectionsTensOfDegreesOffLeadToTheLights) {
  const model::Scene truth = TwoLights();
  const Setting set = Set(truth);
  const auto clusters = observe::LeaderClustering(
      observe::HighIntensityArea(observe::MakeIntensityMap(set.sample.pixels), 0.5),
      DegToRad(25.0));
  for (const double degrees : {0.0, 10.0, 50.0}) {
    std::vector<model::Rung> ladder;
    const Candidate found = FitGuess(set.sample, GuessOff(truth, degrees), clusters, ladder);
    EXPECT_LT(WorstDirection(found.scene, truth), 0.5) << degrees;
    ASSERT_FALSE(ladder.empty());
    EXPECT_EQ(ladder.back().rung, "lights");
    EXPECT_EQ(ladder.back().why, "2, as given by --initial");
  }
}

// Both guesses at one place, on the far side: nothing that is near leads out of there.
TEST(FitGuess, BothAtOnePlaceLeadElsewhereAndTheLadderSaysSo) {
  const model::Scene truth = TwoLights();
  const Setting set = Set(truth);
  const auto clusters = observe::LeaderClustering(
      observe::HighIntensityArea(observe::MakeIntensityMap(set.sample.pixels), 0.5),
      DegToRad(25.0));
  model::InitialGuess guess;
  guess.lights.assign(2, {Vector3d(0.0, -0.2, -1.0).normalized(), 0.0, 1.0, Vector3d::Ones()});
  std::vector<model::Rung> ladder;
  const Candidate found = FitGuess(set.sample, guess, clusters, ladder);
  EXPECT_LT(WorstDirection(found.scene, truth), 0.5);
  ASSERT_EQ(ladder.size(), 2u);
  EXPECT_EQ(ladder[0].rung, "initial");
  EXPECT_FALSE(ladder[0].accepted) << ladder[0].why;
}

TEST(FitGuess, TheModelsGivenAreKept) {
  model::Scene truth = TwoLights();
  truth.reflectance.specular_model = model::SpecularModel::kBlinnPhong;
  const Setting set = Set(truth);
  model::InitialGuess guess = GuessOff(truth, 5.0);
  guess.reflectance = truth.reflectance;
  std::vector<model::Rung> ladder;
  const Candidate found = FitGuess(set.sample, guess, {}, ladder);
  EXPECT_EQ(found.scene.reflectance.specular_model, model::SpecularModel::kBlinnPhong);
  EXPECT_LT(WorstDirection(found.scene, truth), 0.5);
  EXPECT_NEAR(found.scene.reflectance.shininess, 25.0, 1.0);
}

}  // namespace
}  // namespace turnlight::estimator::start
