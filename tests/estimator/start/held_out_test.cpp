// Proves, on random surface points with the scene model's own radiances and noise: the held-out
// check removes a light that is not there, however strong the candidate says it is, and no true
// one; a number of lights that is asked for is kept. Does not prove it on pictures of a target
// (recovery_test).
#include "estimator/start/held_out.h"

#include <gtest/gtest.h>

#include "tests/estimator/start/noisy_sample.h"

namespace turnlight::estimator::start {
namespace {

TEST(HeldOut, TrueLightsStay) {
  const model::Scene truth = TwoLights();
  const Sample sample = NoisySample(truth);
  std::vector<model::Rung> ladder;
  const Candidate fitted = FitStart(sample, truth);
  const Candidate checked = CheckHeldOut(NoisyPixels(truth, 2), sample, fitted, ladder);
  EXPECT_LT(WorstDirectionDeg(checked.scene.lights, truth.lights), 0.5);
  ASSERT_EQ(ladder.size(), 2u);
  for (const model::Rung& rung : ladder) {
    EXPECT_EQ(rung.rung, "held-out light");
    EXPECT_TRUE(rung.accepted) << rung.why;
  }
}

TEST(HeldOut, ALightThatIsNotThereGoes) {
  const model::Scene truth = TwoLights();
  const Sample sample = NoisySample(truth);
  model::Scene more = truth;
  more.lights.push_back(ThirdLight());
  Candidate as_said;
  as_said.scene = more;
  for (const Candidate& candidate : {as_said, FitStart(sample, more)}) {
    ASSERT_EQ(candidate.scene.lights.size(), 3u);
    std::vector<model::Rung> ladder;
    const Candidate checked = CheckHeldOut(NoisyPixels(truth, 2), sample, candidate, ladder);
    EXPECT_LT(WorstDirectionDeg(checked.scene.lights, truth.lights), 0.5);
    ASSERT_EQ(ladder.size(), 3u);
    EXPECT_TRUE(ladder[0].accepted) << ladder[0].why;
    EXPECT_TRUE(ladder[1].accepted) << ladder[1].why;
    EXPECT_FALSE(ladder[2].accepted) << ladder[2].why;
    EXPECT_EQ(ladder[2].why.find("the light from ("), 0u) << ladder[2].why;
  }
}

// Asked for three lights there are three, and the ladder says what one of them is worth.
TEST(HeldOut, ANumberOfLightsAskedForIsKept) {
  const model::Scene truth = TwoLights();
  Sample sample = NoisySample(truth);
  sample.choice.lights = 3;
  Candidate candidate;
  candidate.scene = truth;
  candidate.scene.lights.push_back(ThirdLight());
  std::vector<model::Rung> ladder;
  const Candidate checked = CheckHeldOut(NoisyPixels(truth, 2), sample, candidate, ladder);
  EXPECT_EQ(checked.scene.lights.size(), 3u);
  ASSERT_EQ(ladder.size(), 3u);
  EXPECT_FALSE(ladder[2].accepted);
}

}  // namespace
}  // namespace turnlight::estimator::start
