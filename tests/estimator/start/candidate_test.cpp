// Proves: a fit from some degrees off finds the lights and leaves no more than noise, with its
// history from the first cost to the last; lights that are to be distant are. Does not prove that a
// start is near enough (find_lights_test).
#include "estimator/start/candidate.h"

#include <gtest/gtest.h>

#include "estimator/start/start_scene.h"
#include "tests/estimator/start/noisy_sample.h"

namespace turnlight::estimator::start {
namespace {

model::Scene StartSomeDegreesOff(const Sample& sample, const model::Scene& truth) {
  std::vector<Eigen::Vector3d> directions;
  for (const model::Light& light : truth.lights) directions.push_back(Turned(light.direction, 8.0));
  return StartFromDirections(sample.pixels, directions);
}

TEST(FitStart, FindsTheLightsDownToTheNoise) {
  const model::Scene truth = TwoLights();
  const Sample sample = NoisySample(truth);
  const Candidate fitted = FitStart(sample, StartSomeDegreesOff(sample, truth));
  EXPECT_LT(WorstDirectionDeg(fitted.scene.lights, truth.lights), 0.5);
  EXPECT_NEAR(fitted.mean_square, kSampleNoise * kSampleNoise, 0.1 * kSampleNoise * kSampleNoise);
  EXPECT_EQ(fitted.excess, ExcessVariance(fitted.mean_square, kSampleNoise));
  EXPECT_TRUE(NothingLeft(fitted.excess, sample));
  ASSERT_GT(fitted.rms_history.size(), 3u);
  EXPECT_NEAR(fitted.rms_history.back(), std::sqrt(fitted.mean_square), 1e-12);
  for (std::size_t i = 1; i < fitted.rms_history.size(); ++i)
    EXPECT_LE(fitted.rms_history[i], fitted.rms_history[i - 1] * (1.0 + 1e-12));
}

TEST(FitStart, DistantLightsAreDistantIfSoChosen) {
  const model::Scene truth = TwoLights(0.0, 0.0);
  Sample sample = NoisySample(truth);
  sample.choice.near = false;
  const Candidate fitted = FitStart(sample, StartSomeDegreesOff(sample, truth));
  for (const model::Light& light : fitted.scene.lights) EXPECT_EQ(light.inverse_distance, 0.0);
  EXPECT_LT(WorstDirectionDeg(fitted.scene.lights, truth.lights), 0.5);
}

TEST(Refit, GoesOnFromWhereItStands) {
  const model::Scene truth = TwoLights();
  const Sample sample = NoisySample(truth);
  const Candidate fitted = FitStart(sample, StartSomeDegreesOff(sample, truth));
  const Candidate same = Refit(sample, fitted, 0, kSampleNoise, kToKeep);
  EXPECT_NEAR(same.mean_square, fitted.mean_square, 1e-6 * fitted.mean_square);
  EXPECT_EQ(same.rms_history.size(), fitted.rms_history.size());
  // Against a smaller noise the same residual is more.
  EXPECT_GT(Refit(sample, fitted, 0, 0.5 * kSampleNoise, kToKeep).excess, 5.0 * same.excess);
}

}  // namespace
}  // namespace turnlight::estimator::start
