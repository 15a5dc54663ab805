// Proves: from pictures of a known scene with known noise the estimator finds the lights without a
// hint, and the sigmas that it states are those of its errors (100 draws of the noise). The
// pictures come from our own renderer: that the model is right is what the render checks against
// POV-Ray show, not this. Does not prove anything about errors of the model, which these pictures
// have none of.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <map>

#include "base/angles.h"
#include "base/parallel.h"
#include "estimator/estimate.h"
#include "rig/sim/synthetic_session.h"
#include "tests/estimator/small_scene.h"

namespace turnlight::estimator {
namespace {

rig::sim::SyntheticConfig NoisyBall(std::uint64_t seed) { return TwoLightBall(seed, 0.01, 0.15); }

// Mean and spread of an estimate over the draws, and the mean of what was stated.
struct Spread {
  std::vector<double> values;
  double stated = 0.0;

  void Add(double value, double sigma) {
    values.push_back(value);
    stated += sigma;
  }
  double StatedMean() const { return stated / static_cast<double>(values.size()); }
  double Mean() const {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
  }
  double Deviation() const {
    double sum = 0.0;
    for (const double value : values) sum += (value - Mean()) * (value - Mean());
    return std::sqrt(sum / static_cast<double>(values.size() - 1));
  }
};

TEST(RecoveryTest, StatedSigmasAreThoseOfTheErrors) {
  constexpr int kDraws = 100;
  std::map<std::string, Spread> spreads;
  std::vector<Eigen::Vector3d> directions[2];
  double direction_sigma[2] = {0.0, 0.0};
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    const auto session = rig::sim::SynthesizeInMemory(NoisyBall(seed));
    ASSERT_TRUE(session) << session.error().text;
    const auto output = EstimateFrom(*session);
    ASSERT_TRUE(output) << output.error().text;
    const Estimate& e = output->estimate;
    ASSERT_EQ(e.lights.size(), 2u) << "seed " << seed;
    for (std::size_t l = 0; l < 2; ++l) {
      const LightEstimate& light = e.lights[l];
      const std::string name = "light " + std::to_string(l) + " ";
      directions[l].push_back(light.light.direction);
      direction_sigma[l] += light.direction_sigma / kDraws;
      spreads[name + "rho"].Add(light.light.inverse_distance, light.inverse_distance_sigma);
      spreads[name + "specular"].Add(light.specular_product[0], light.specular_product_sigma[0]);
      for (int c = 0; c < 3; ++c)
        spreads[name + "diffuse " + std::to_string(c)].Add(light.diffuse_product[c],
                                                           light.diffuse_product_sigma[c]);
    }
    for (int c = 0; c < 3; ++c)
      spreads["ambient " + std::to_string(c)].Add(e.ambient_product[c], e.ambient_product_sigma[c]);
    spreads["shininess"].Add(e.reflectance.lobes[0].shape, e.sigma.lobes[0].shape.value());
  }
  for (const auto& [name, spread] : spreads) {
    const double ratio = spread.Deviation() / spread.StatedMean();
    RecordProperty("ratio " + name, std::to_string(ratio));
    EXPECT_GT(ratio, 0.8) << name;
    EXPECT_LT(ratio, 1.25) << name;
  }
  for (std::size_t l = 0; l < 2; ++l) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& u : directions[l]) mean += u / kDraws;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& u : directions[l])
      covariance += (u - mean) * (u - mean).transpose() / (kDraws - 1);
    const double largest =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues().maxCoeff();
    const double ratio = std::sqrt(largest) / direction_sigma[l];
    EXPECT_GT(ratio, 0.8) << "direction of light " << l;
    EXPECT_LT(ratio, 1.25) << "direction of light " << l;
  }
}

TEST(RecoveryTest, ErrorsAreWithinFourSigmaOfTheTruth) {
  const auto session = rig::sim::SynthesizeInMemory(NoisyBall(1));
  ASSERT_TRUE(session);
  const auto output = EstimateFrom(*session);
  ASSERT_TRUE(output);
  const Estimate& e = output->estimate;
  ASSERT_EQ(e.lights.size(), 2u);
  for (std::size_t l = 0; l < 2; ++l) {
    const model::Light& truth = session->scene.lights[l];
    const LightEstimate& light = e.lights[l];
    EXPECT_TRUE(light.near);
    EXPECT_LT((light.light.direction - truth.direction).norm(), 4.0 * light.direction_sigma);
    EXPECT_LT(std::abs(light.light.inverse_distance - truth.inverse_distance),
              4.0 * light.inverse_distance_sigma);
    const model::Reflectance& r = session->scene.reflectance;
    for (int c = 0; c < 3; ++c)
      EXPECT_LT(std::abs(light.diffuse_product[c] - r.albedo[c] * r.diffuse * truth.intensity),
                4.0 * light.diffuse_product_sigma[c]);
  }
}

TEST(RecoveryTest, TheGaugeIsTheStatedOne) {
  const auto session = rig::sim::SynthesizeInMemory(NoisyBall(2));
  const auto output = EstimateFrom(*session);
  ASSERT_TRUE(output);
  EXPECT_DOUBLE_EQ(output->estimate.reflectance.albedo.maxCoeff(), 1.0);
  EXPECT_DOUBLE_EQ(output->estimate.lights.front().light.intensity, 1.0);
  EXPECT_FALSE(output->estimate.lights.front().intensity_sigma.has_value());
}

TEST(RecoveryTest, AHintOfFiveDegreesOffLeadsToTheSameAnswer) {
  const auto session = rig::sim::SynthesizeInMemory(NoisyBall(3));
  ASSERT_TRUE(session);
  const auto without = EstimateFrom(*session);
  EstimateOptions options;
  options.initial = model::InitialGuess{};
  for (const model::Light& light : session->scene.lights) {
    model::Light off = light;
    off.direction =
        (light.direction + std::tan(DegToRad(5.0)) * light.direction.unitOrthogonal()).normalized();
    off.inverse_distance = 0.0;
    options.initial->lights.push_back(off);
  }
  const auto with = EstimateFrom(*session, options);
  ASSERT_TRUE(without && with);
  for (std::size_t l = 0; l < 2; ++l)
    EXPECT_LT(
        (without->estimate.lights[l].light.direction - with->estimate.lights[l].light.direction)
            .norm(),
        0.1 * with->estimate.lights[l].direction_sigma);
}

TEST(RepeatabilityTest, SameBitsWithAnyNumberOfThreads) {
  const auto session = rig::sim::SynthesizeInMemory(NoisyBall(4));
  ASSERT_TRUE(session);
  std::vector<double> first;
  for (const int threads : {1, 2, 7, 1}) {
    SetThreads(threads);
    const auto output = EstimateFrom(*session);
    ASSERT_TRUE(output);
    std::vector<double> all;
    for (const LightEstimate& light : output->estimate.lights) {
      all.insert(all.end(), light.light.direction.data(), light.light.direction.data() + 3);
      all.push_back(light.light.inverse_distance);
      all.push_back(light.direction_sigma);
    }
    all.push_back(output->estimate.rms);
    all.push_back(output->estimate.reflectance.lobes[0].shape);
    if (first.empty()) first = all;
    EXPECT_EQ(all, first) << threads << " threads";
  }
  SetThreads(0);
}

// Pictures that hold no answer must say so.
Result<EstimateOutput> RunFilled(float radiance, bool saturated) {
  auto config = NoisyBall(5);
  config.sensor.noise_relative = 0.0;
  const auto session = rig::sim::SynthesizeInMemory(config);
  std::vector<model::Keyframe> keyframes = rig::sim::ToKeyframes(*session);
  for (model::Keyframe& keyframe : keyframes) {
    keyframe.image.radiance.setTo(cv::Scalar::all(static_cast<double>(radiance)));
    keyframe.image.saturated.setTo(saturated ? 255 : 0);
  }
  return EstimateScene(keyframes, target::Geometry(session->target),
                       calib::RayGrid(session->camera), {});
}

TEST(NoAnswerTest, AllBlack) {
  const auto output = RunFilled(0.0f, false);
  ASSERT_FALSE(output);
  EXPECT_EQ(output.error().kind, ErrorKind::kNoEstimate);
  EXPECT_NE(output.error().text.find("black"), std::string::npos) << output.error().text;
}

TEST(NoAnswerTest, AllClipped) {
  const auto output = RunFilled(1.0f, true);
  ASSERT_FALSE(output);
  EXPECT_EQ(output.error().kind, ErrorKind::kNoEstimate);
  EXPECT_NE(output.error().text.find("clipped"), std::string::npos) << output.error().text;
  EXPECT_NE(output.error().text.find("lower the exposure"), std::string::npos);
}

TEST(NoAnswerTest, TargetOutOfView) {
  auto config = NoisyBall(6);
  const auto session = rig::sim::SynthesizeInMemory(config);
  std::vector<model::Keyframe> keyframes = rig::sim::ToKeyframes(*session);
  for (model::Keyframe& keyframe : keyframes) keyframe.X_WT.translation = {0.0, 0.0, 1e5};
  const auto output = EstimateScene(keyframes, target::Geometry(session->target),
                                    calib::RayGrid(session->camera), {});
  ASSERT_FALSE(output);
  EXPECT_EQ(output.error().kind, ErrorKind::kNoEstimate);
  EXPECT_NE(output.error().text.find("No pixel shows the target"), std::string::npos);
}

TEST(NoAnswerTest, UniformLightHasNoDirection) {
  // A constant picture: there is no light to be found, and whatever is said must not look good.
  const auto output = RunFilled(0.3f, false);
  if (!output) return;
  for (const LightEstimate& light : output->estimate.lights)
    EXPECT_FALSE(light.direction_sigma < DegToRad(1.0) && light.diffuse_product.norm() > 0.01);
}

}  // namespace
}  // namespace turnlight::estimator
