// Proves that drawn scenes keep their promises (cap, separation, intervals) and depend on the seed
// only. Does not prove that the distributions have the stated shapes inside the intervals.
#include "rig/sim/random_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/angles.h"

namespace turnlight::rig::sim {
namespace {

using ::testing::HasSubstr;

SyntheticConfig ManyLights(std::uint64_t seed) {
  SyntheticConfig config;
  config.seed = seed;
  config.lights = RandomLights{.count = 8,
                               .min_separation_deg = 20.0,
                               .zenith_max_deg = 80.0,
                               .distance = {300.0, 900.0},
                               .distant_share = 0.5,
                               .intensity = {0.25, 0.5}};
  return config;
}

TEST(RandomScene, KeepsItsPromises) {
  int distant = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const auto scene = DrawScene(ManyLights(seed));
    ASSERT_TRUE(scene) << scene.error().text;
    ASSERT_EQ(scene->lights.size(), 8u);
    for (std::size_t i = 0; i < 8; ++i) {
      const estimator::model::Light& light = scene->lights[i];
      EXPECT_NEAR(light.direction.norm(), 1.0, 1e-14);
      EXPECT_LE(RadToDeg(std::acos(light.direction.z())), 80.0 + 1e-9);
      EXPECT_GE(light.intensity, 0.25);
      EXPECT_LE(light.intensity, 0.5);
      if (light.inverse_distance == 0.0) {
        ++distant;
      } else {
        EXPECT_GE(1.0 / light.inverse_distance, 300.0 - 1e-9);
        EXPECT_LE(1.0 / light.inverse_distance, 900.0 + 1e-9);
      }
      for (std::size_t k = 0; k < i; ++k)
        EXPECT_GE(RadToDeg(std::acos(light.direction.dot(scene->lights[k].direction))),
                  20.0 - 1e-9);
    }
    const estimator::model::Reflectance& r = scene->reflectance;
    EXPECT_GE(r.lobes[0].shape, 10.0);
    EXPECT_LE(r.lobes[0].shape, 100.0);
    EXPECT_GE(r.albedo.minCoeff(), 0.2);
    EXPECT_LE(r.albedo.maxCoeff(), 0.8);
  }
  EXPECT_GT(distant, 150);  // of 400, half are expected
  EXPECT_LT(distant, 250);
}

TEST(RandomScene, DependsOnTheSeedOnly) {
  const auto a = DrawScene(ManyLights(7));
  const auto b = DrawScene(ManyLights(7));
  const auto c = DrawScene(ManyLights(8));
  ASSERT_TRUE(a && b && c);
  EXPECT_EQ(a->lights[3].direction, b->lights[3].direction);
  EXPECT_NE(a->lights[3].direction, c->lights[3].direction);
}

TEST(RandomScene, SaysWhenTheLightsDoNotFit) {
  SyntheticConfig config = ManyLights(1);
  std::get<RandomLights>(config.lights).min_separation_deg = 90.0;
  const auto scene = DrawScene(config);
  ASSERT_FALSE(scene);
  EXPECT_THAT(scene.error().text, HasSubstr("random_lights/min_separation_deg: 90"));
}

TEST(RandomScene, ListedLightsAreTakenAsTheyAre) {
  SyntheticConfig config;
  config.lights =
      std::vector<LightSpec>{{{0, 0, 2}, 500.0, 0.7, {1, 0.5, 0.5}}, {{0, 3, 4}, {}, 1, {1, 1, 1}}};
  const auto scene = DrawScene(config);
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->lights[0].direction, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(scene->lights[0].inverse_distance, 1.0 / 500.0);
  EXPECT_EQ(scene->lights[0].color, Eigen::Vector3d(1, 0.5, 0.5));
  EXPECT_EQ(scene->lights[1].inverse_distance, 0.0);
}

TEST(RandomScene, ModelsAreKept) {
  SyntheticConfig config;
  RandomReflectance random;
  random.model = estimator::model::SpecularModel::kNone;
  random.diffuse_model = estimator::model::DiffuseModel::kOrenNayar;
  random.roughness_deg = {20.0, 20.0};
  config.reflectance = random;
  const auto scene = DrawScene(config);
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->reflectance.lobes[0].model, estimator::model::SpecularModel::kNone);
  EXPECT_EQ(scene->reflectance.lobes[0].strength, 0.0);
  EXPECT_DOUBLE_EQ(scene->reflectance.roughness, DegToRad(20.0));
}

}  // namespace
}  // namespace turnlight::rig::sim
