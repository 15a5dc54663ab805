// Proves that every key of the generator's YAML is read, kept by `config show`, and refused by
// file, line and key when it is wrong. Does not prove that the generator obeys them;
// synthetic_session_test does.
#include "rig/sim/synthetic_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "base/angles.h"

namespace turnlight::rig::sim {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string Refusal(const std::string& text) {
  const auto config = ParseSyntheticConfig(text, "c.yaml");
  return config ? "accepted" : config.error().text;
}

constexpr const char* kFull = R"(
seed: 12
name: all keys
target: {shape: plane, size: [120, 90], sides: 2}
motion: {kind: table, frames: 5, step_deg: -15, distance: 300, elevation_deg: 40, tilt_deg: 10}
camera: {size: [64, 48], focal_px: 100, lens: opencv8, distortion: [0.1, 0, 0, 0, 0, 0, 0, 0.01]}
lights:
  - {direction: [0, 0, 1], distance: 500, intensity: 0.7, color: [1, 0.9, 0.8]}
  - {direction: [1, 0, 1], distance: null}
reflectance: {model: blinn-phong, albedo: [0.5, 0.4, 0.3], ambient: 0.05, diffuse: 0.6,
              specular: 0.25, shininess: 30, diffuse_model: oren-nayar, roughness_deg: 15}
sensor: {bits: 8, format: tiff, encoding: {gamma: 2.0}, black: 4, white: 250, saturation: 240,
         noise_relative: 0.01, noise_shot: 0.02, clip_share: 0.05}
samples_per_side: 3
masks: true
)";

TEST(SyntheticConfig, ReadsEveryKey) {
  const auto config = ParseSyntheticConfig(kFull, "c.yaml");
  ASSERT_TRUE(config) << config.error().text;
  EXPECT_EQ(config->seed, 12u);
  EXPECT_EQ(config->name, "all keys");
  const auto& plane = std::get<calib::PlaneShape>(config->target);
  EXPECT_EQ(plane.width, 120.0);
  EXPECT_EQ(plane.height, 90.0);
  EXPECT_EQ(plane.sides, 2);
  EXPECT_EQ(config->motion.kind, MotionKind::kTable);
  EXPECT_EQ(config->motion.frames, 5);
  EXPECT_EQ(config->motion.step_deg, -15.0);
  EXPECT_EQ(config->motion.distance, 300.0);
  EXPECT_EQ(config->motion.elevation_deg, 40.0);
  EXPECT_EQ(config->motion.tilt_deg, 10.0);
  EXPECT_EQ(config->camera.width, 64);
  EXPECT_EQ(config->camera.height, 48);
  EXPECT_EQ(config->camera.focal_px, 100.0);
  EXPECT_EQ((*config->camera.distortion)[7], 0.01);
  const auto& lights = std::get<std::vector<LightSpec>>(config->lights);
  ASSERT_EQ(lights.size(), 2u);
  EXPECT_EQ(lights[0].distance, 500.0);
  EXPECT_EQ(lights[0].color, Eigen::Vector3d(1, 0.9, 0.8));
  EXPECT_FALSE(lights[1].distance);
  const auto& r = std::get<estimator::model::Reflectance>(config->reflectance);
  EXPECT_EQ(r.lobes[0].model, estimator::model::SpecularModel::kBlinnPhong);
  EXPECT_DOUBLE_EQ(r.roughness, DegToRad(15.0));
  EXPECT_EQ(config->sensor.depth, SensorDepth::k8);
  EXPECT_EQ(config->sensor.Format(), FileFormat::kTiff);
  EXPECT_EQ(config->sensor.encoding, calib::Encoding::kGamma);
  EXPECT_EQ(config->sensor.gamma, 2.0);
  EXPECT_EQ(config->sensor.black, 4.0);
  EXPECT_EQ(config->sensor.white, 250.0);
  EXPECT_EQ(config->sensor.saturation, 240.0);
  EXPECT_EQ(config->sensor.noise_relative, 0.01);
  EXPECT_EQ(config->sensor.noise_shot, 0.02);
  EXPECT_EQ(config->sensor.clip_share, 0.05);
  EXPECT_EQ(config->samples_per_side, 3);
  EXPECT_TRUE(config->masks);
}

TEST(SyntheticConfig, TheLensMayDarkenTheCorners) {
  const auto config = ParseSyntheticConfig("{camera: {vignetting: 0.3}}", "c.yaml");
  ASSERT_TRUE(config) << config.error().text;
  EXPECT_EQ(config->camera.vignetting, 0.3);
  const auto refused = ParseSyntheticConfig("{camera: {vignetting: 1.5}}", "c.yaml");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().text.find("camera/vignetting: 1.5, allowed is"), std::string::npos);
}

TEST(SyntheticConfig, AnEmptyObjectIsTheDefaults) {
  const auto config = ParseSyntheticConfig("{}", "c.yaml");
  ASSERT_TRUE(config) << config.error().text;
  EXPECT_EQ(ToYaml(*config), ToYaml(SyntheticConfig{}));
  EXPECT_FALSE(Validate(SyntheticConfig{}));
}

TEST(SyntheticConfig, WhatIsShownReadsBackTheSame) {
  for (const char* text :
       {kFull, "{}",
        "{target: {shape: blob, depth: 0.2}, random_lights: {count: 3, distance: [400, 500]}, "
        "random_reflectance: {model: none, diffuse_model: oren-nayar}, sensor: {bits: float}}",
        "{motion: {frames: 2}, lights: [{direction: [0, 0, 1], factors: [0.9, 1.1]}], "
        "reflectance: {model: none, albedo: [1, 1, 1], ambient: 0.1, diffuse: 0.5, specular: 0, "
        "ambient_harmonics: [0.01, 0, 0, 0, 0.02, 0, 0, 0]}}"}) {
    const auto config = ParseSyntheticConfig(text, "c.yaml");
    ASSERT_TRUE(config) << config.error().text;
    const std::string shown = ToYaml(*config);
    const auto back = ParseSyntheticConfig(shown, "shown.yaml");
    ASSERT_TRUE(back) << back.error().text << "\n" << shown;
    EXPECT_EQ(ToYaml(*back), shown);
  }
}

struct BadCase {
  const char* text;
  const char* key;
};

class SyntheticConfigRefusal : public ::testing::TestWithParam<BadCase> {};

TEST_P(SyntheticConfigRefusal, NamesFileLineAndKey) {
  // A first line moves the refused key to line 2.
  const std::string text = std::string("name: bad\n") + GetParam().text;
  EXPECT_THAT(Refusal(text), AllOf(HasSubstr("c.yaml:2: "), HasSubstr(GetParam().key))) << text;
}

INSTANTIATE_TEST_SUITE_P(
    AllKeys, SyntheticConfigRefusal,
    ::testing::Values(
        BadCase{"seed: -1", "seed"}, BadCase{"masks: maybe", "masks"},
        BadCase{"samples_per_side: 33", "samples_per_side"}, BadCase{"lamps: 2", "lamps"},
        BadCase{"target: {shape: cube}", "target/shape"},
        BadCase{"target: {shape: sphere, radius: 0}", "target/radius"},
        BadCase{"target: {shape: sphere, size: [1, 1]}", "target/size"},
        BadCase{"target: {shape: plane, size: [1, 0]}", "target/size"},
        BadCase{"target: {shape: plane, sides: 3}", "target/sides"},
        BadCase{"target: {shape: blob, depth: 0.6}", "target/depth"},
        BadCase{"target: {shape: blob, segments: 9}", "target/segments"},
        BadCase{"motion: {kind: fly}", "motion/kind"},
        BadCase{"motion: {frames: 0}", "motion/frames"},
        BadCase{"motion: {step_deg: 400}", "motion/step_deg"},
        BadCase{"motion: {distance: 40}", "motion/distance"},
        BadCase{"motion: {elevation_deg: 91}", "motion/elevation_deg"},
        BadCase{"motion: {tilt_deg: 10}", "motion/tilt_deg"},
        BadCase{"camera: {size: [64, 4]}", "camera/size"},
        BadCase{"camera: {size: [64.5, 48]}", "camera/size"},
        BadCase{"camera: {focal_px: 0}", "camera/focal_px"},
        BadCase{"camera: {lens: fisheye}", "camera/lens"},
        BadCase{"camera: {distortion: [0, 0, 0, 0, 0, 0, 0, 0]}", "camera/distortion"},
        BadCase{"camera: {lens: opencv8, distortion: [1]}", "camera/distortion"},
        BadCase{"lights: []", "lights"},
        BadCase{"lights: [{direction: [0, 0, 0]}]", "lights/0/direction"},
        BadCase{"lights: [{direction: [0, 0, 1], factors: [1, 1]}]", "lights/0/factors"},
        BadCase{"lights: [{direction: [0, 0, 1], distance: 30}]", "lights/0/distance"},
        BadCase{"lights: [{direction: [0, 0, 1], intensity: 0}]", "lights/0/intensity"},
        BadCase{"lights: [{direction: [0, 0, 1], color: [1, 1]}]", "lights/0/color"},
        BadCase{"lights: [{direction: [0, 0, 1], watts: 1}]", "lights/0/watts"},
        BadCase{"random_lights: {count: 0}", "random_lights/count"},
        BadCase{"random_lights: {min_separation_deg: 190}", "random_lights/min_separation_deg"},
        BadCase{"random_lights: {zenith_max_deg: -1}", "random_lights/zenith_max_deg"},
        BadCase{"random_lights: {distance: [40, 900]}", "random_lights/distance"},
        BadCase{"random_lights: {distance: [900, 400]}", "random_lights/distance"},
        BadCase{"random_lights: {distant_share: 2}", "random_lights/distant_share"},
        BadCase{"random_lights: {intensity: [0, 1]}", "random_lights/intensity"},
        BadCase{"reflectance: {model: velvet}", "reflectance/model"},
        BadCase{"random_reflectance: {model: velvet}", "random_reflectance/model"},
        BadCase{"random_reflectance: {diffuse_model: wax}", "random_reflectance/diffuse_model"},
        BadCase{"random_reflectance: {albedo: [1, 0]}", "random_reflectance/albedo"},
        BadCase{"random_reflectance: {ambient: [-1, 0]}", "random_reflectance/ambient"},
        BadCase{"random_reflectance: {diffuse: [-1, 0]}", "random_reflectance/diffuse"},
        BadCase{"random_reflectance: {specular: 1}", "random_reflectance/specular"},
        BadCase{"random_reflectance: {shininess: [0.1, 9]}", "random_reflectance/shininess"},
        BadCase{"random_reflectance: {roughness_deg: [0, 91]}", "random_reflectance/roughness_deg"},
        BadCase{"sensor: {bits: 12}", "sensor/bits"},
        BadCase{"sensor: {format: jpeg}", "sensor/format"},
        BadCase{"sensor: {bits: 8, format: exr}", "sensor"},
        BadCase{"sensor: {bits: float, format: png}", "sensor"},
        BadCase{"sensor: {encoding: log}", "sensor/encoding"},
        BadCase{"sensor: {encoding: {gamma: 0}}", "sensor/encoding"},
        BadCase{"sensor: {black: -1}", "sensor/black"},
        BadCase{"sensor: {white: 70000}", "sensor/white"},
        BadCase{"sensor: {black: 100, saturation: 100}", "sensor/saturation"},
        BadCase{"sensor: {noise_relative: 2}", "sensor/noise_relative"},
        BadCase{"sensor: {noise_shot: -1}", "sensor/noise_shot"},
        BadCase{"sensor: {clip_share: 1}", "sensor/clip_share"}));

TEST(SyntheticConfig, OneOfTwoKeysOnly) {
  EXPECT_THAT(Refusal("lights: [{direction: [0, 0, 1]}]\nrandom_lights: {}"),
              HasSubstr("beside lights"));
  EXPECT_THAT(Refusal("reflectance: {}\nrandom_reflectance: {}"), HasSubstr("beside reflectance"));
}

TEST(SyntheticConfig, NameMustNotBeEmpty) { EXPECT_THAT(Refusal("name: ''"), HasSubstr("name")); }

TEST(SyntheticConfig, AMissingFileIsNamed) {
  const auto config = ReadSyntheticConfig("/nowhere/c.yaml");
  ASSERT_FALSE(config);
  EXPECT_THAT(config.error().text, HasSubstr("/nowhere/c.yaml"));
}

}  // namespace
}  // namespace turnlight::rig::sim
