// Proves: lights that are not there go, however many, and true ones stay, however weak beside the
// others as long as they are above the noise; of no light at all none is left; a number that is
// asked for is kept. Does not prove the ratio of three: bench/studies does.
#include "estimator/start/eliminate_lights.h"

#include <gtest/gtest.h>

#include "tests/estimator/start/noisy_sample.h"

namespace turnlight::estimator::start {
namespace {

TEST(Eliminate, LightsThatAreNotThereGo) {
  const model::Scene truth = TwoLights();
  const Sample sample = NoisySample(truth);
  model::Scene more = truth;
  more.lights.push_back(ThirdLight());
  more.lights.push_back(ThirdLight());
  more.lights[3].direction = Eigen::Vector3d(0.9, 0.2, 0.1).normalized();
  const Candidate left = Eliminate(sample, FitStart(sample, more));
  EXPECT_LT(WorstDirectionDeg(left.scene.lights, truth.lights), 0.5);
  EXPECT_TRUE(NothingLeft(left.excess, sample));
}

TEST(Eliminate, AWeakTrueLightStays) {
  model::Scene truth = TwoLights();
  truth.lights.push_back(ThirdLight(0.05));
  const Sample sample = NoisySample(truth);
  const Candidate left = Eliminate(sample, FitStart(sample, truth));
  EXPECT_LT(WorstDirectionDeg(left.scene.lights, truth.lights), 2.0);
}

TEST(Eliminate, AmbientLightAloneLeavesNoLight) {
  model::Scene truth = TwoLights();
  for (model::Light& light : truth.lights) light.intensity = 0.0;
  const Sample sample = NoisySample(truth);
  EXPECT_TRUE(Eliminate(sample, FitStart(sample, TwoLights())).scene.lights.empty());
}

TEST(Eliminate, ANumberAskedForIsKept) {
  const model::Scene truth = TwoLights();
  Sample sample = NoisySample(truth);
  model::Scene more = truth;
  more.lights.push_back(ThirdLight());
  for (const int wanted : {1, 2, 3}) {
    sample.choice.lights = wanted;
    EXPECT_EQ(Eliminate(sample, FitStart(sample, more)).scene.lights.size(),
              static_cast<std::size_t>(wanted));
  }
}

}  // namespace
}  // namespace turnlight::estimator::start
