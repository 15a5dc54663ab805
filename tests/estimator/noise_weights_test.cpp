// Proves on a few scenes with strong shot noise: weighing pixels by the sensor's noise lowers the
// errors of the lights' directions together; keyframes one by one have the weights of all at once.
// Does not prove by how much in general (noise_weights_study).
#include "tests/estimator/noise_weights.h"

#include <gtest/gtest.h>

#include "estimator/observe/observations.h"
#include "estimator/observe/sampling.h"

namespace turnlight::estimator {
namespace {

TEST(NoiseWeights, LowerTheErrorOfDirections) {
  double uniform = 0.0, weighted = 0.0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const auto errors = EstimateBothWays(seed);
    ASSERT_TRUE(errors) << errors.error().text;
    uniform += errors->uniform * errors->uniform;
    weighted += errors->weighted * errors->weighted;
  }
  RecordProperty("ratio", std::to_string(std::sqrt(weighted / uniform)));
  EXPECT_LT(weighted, 0.9 * uniform);
}

TEST(NoiseWeights, PartsTogetherAreTheWhole) {
  const rig::sim::SyntheticConfig config = ShotNoiseBall(1);
  auto session = rig::sim::SynthesizeInMemory(config);
  ASSERT_TRUE(session) << session.error().text;
  session->radiometry.noise = NoiseOfSensor(config, session->radiometry);
  const auto keyframes = rig::sim::ToKeyframes(*session);
  const target::Geometry geometry(session->target);
  const calib::RayGrid rays(session->camera);
  const observe::Observations whole = observe::BuildObservations(keyframes, geometry, rays);
  std::vector<observe::Observations> parts;
  for (const model::Keyframe& keyframe : keyframes)
    parts.push_back(observe::BuildPart(keyframe, geometry, rays));
  const observe::Observations together = observe::Concatenate(parts);
  ASSERT_EQ(whole.weight.size(), whole.size());
  EXPECT_EQ(whole.weight, together.weight);
  EXPECT_EQ(whole.variance, together.variance);
  // The median pixel weighs 1, a dark one more.
  std::size_t heavier = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) heavier += whole.weight[i] > 1.0f ? 1 : 0;
  EXPECT_NEAR(static_cast<double>(heavier) / static_cast<double>(whole.used), 0.5, 0.01);
  const observe::Observations sample = observe::Subsample(whole, 500, 1);
  EXPECT_EQ(sample.weight.size(), sample.size());
  // One keyframe without a variance: no weights at all.
  observe::DropWeights(parts.front());
  EXPECT_TRUE(observe::Concatenate(parts).weight.empty());
}

}  // namespace
}  // namespace turnlight::estimator
