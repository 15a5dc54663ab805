// Proves that every value of an estimate lands under the design's key, that nothing unknown becomes
// a number, and that a written result reads back as the scene that was estimated. Does not prove
// that the values are right; tests/estimator does.
#include "app/result_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "app/summary.h"
#include "base/angles.h"
#include "rig/sim/scene_file.h"

namespace turnlight::app {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

estimator::Estimate Example() {
  estimator::Estimate e;
  estimator::LightEstimate near;
  near.light = {Eigen::Vector3d(0.36, 0.48, 0.8), 1.0 / 700.0, 1.0, {1, 1, 1}};
  near.near = true;
  near.direction_sigma = DegToRad(0.012);
  near.inverse_distance_sigma = 2e-6;
  near.distance = 700.0;
  near.distance_sigma = 1.24;
  near.distance_min = 697.6;
  near.position = Eigen::Vector3d(252, 336, 560);
  near.position_covariance = Eigen::Matrix3d::Identity();
  near.diffuse_product = {0.1, 0.2, 0.3};
  near.specular_product = 0.35;
  estimator::LightEstimate distant;
  distant.light = {Eigen::Vector3d::UnitZ(), 0.0, 0.5, {1, 1, 1}};
  distant.intensity_sigma = 0.01;
  distant.distance_min = 9000.0;
  e.lights = {near, distant};
  e.stat.lights.resize(2);
  e.stat.lights[0].direction = DegToRad(0.004);
  e.stat.lights[0].distance = 0.5;
  e.stat.lights[1].distance = 0.5;  // of a distance that is not given
  e.reflectance.albedo = {0.4, 0.9, 1.0};
  e.reflectance.specular = 0.35;
  e.reflectance.shininess = 40.0;
  e.sigma.shininess = 0.4;
  e.condition = 1234.0;
  e.pixels = 4321;
  e.views = 36;
  e.ladder = {{"one more light", false, "it explains 0.01 % of the energy"}};
  e.notes = {{"views-add-nothing", "all views show the same"}};
  e.stopped = estimator::solve::Stopped::kTolerance;
  return e;
}

nlohmann::ordered_json ToJson(const estimator::Estimate& e) {
  return ResultToJson(e, "name", "lm", {0.5, 2.0});
}

std::string Codes(const nlohmann::ordered_json& json) {
  std::string codes;
  for (const auto& note : json["notes"]) codes += note["code"].get<std::string>() + " ";
  return codes;
}

TEST(ResultJson, ValuesStandUnderTheirKeys) {
  const auto json = ToJson(Example());
  EXPECT_EQ(json["model"]["near"], nlohmann::json({true, false}));
  EXPECT_EQ(json["model"]["ladder"][0]["accepted"], false);
  EXPECT_NEAR(json["lights"][0]["direction_sigma_deg"].get<double>(), 0.012, 1e-12);
  EXPECT_NEAR(json["lights"][0]["stat"]["direction_sigma_deg"].get<double>(), 0.004, 1e-12);
  EXPECT_EQ(json["lights"][0]["stat"]["distance_sigma"], 0.5);
  EXPECT_TRUE(json["lights"][1]["stat"]["distance_sigma"].is_null());
  EXPECT_EQ(json["lights"][0]["position"], nlohmann::json({252.0, 336.0, 560.0}));
  EXPECT_EQ(json["lights"][0]["position_covariance"][1], nlohmann::json({0.0, 1.0, 0.0}));
  EXPECT_EQ(json["products"]["diffuse"][0], nlohmann::json({0.1, 0.2, 0.3}));
  EXPECT_EQ(json["products"]["specular"][0], 0.35);
  EXPECT_EQ(json["reflectance"]["lobe"]["peak"], 0.35);
  EXPECT_FALSE(json["reflectance"].contains("roughness_deg"));
  EXPECT_EQ(json["time_s"]["total"], 2.0);
}

TEST(ResultJson, WhatIsUnknownIsNullWithANote) {
  const auto json = ToJson(Example());
  EXPECT_TRUE(json["lights"][0]["intensity_sigma"].is_null());
  EXPECT_TRUE(json["lights"][1]["distance"].is_null());
  EXPECT_TRUE(json["lights"][1]["position"].is_null());
  EXPECT_THAT(Codes(json), HasSubstr("views-add-nothing"));
  EXPECT_THAT(Codes(json), HasSubstr("null-intensity-sigma"));
  EXPECT_THAT(Codes(json), Not(HasSubstr("null-distance-min")));
  EXPECT_THAT(Codes(json), Not(HasSubstr("null-sigma")));
}

TEST(ResultJson, WithoutALobeThereIsNoShininess) {
  estimator::Estimate e = Example();
  e.reflectance.specular_model = estimator::model::SpecularModel::kNone;
  e.sigma.shininess.reset();
  const auto json = ToJson(e);
  EXPECT_TRUE(json["reflectance"]["shininess"].is_null());
  EXPECT_TRUE(json["reflectance"]["lobe"].is_null());
  EXPECT_EQ(json["reflectance"]["specular"], 0.0);
}

TEST(ResultJson, NoInfinityGetsOut) {
  estimator::Estimate e = Example();
  e.condition = std::numeric_limits<double>::infinity();
  e.lights[0].inverse_distance_sigma = std::numeric_limits<double>::quiet_NaN();
  const auto json = ToJson(e);
  EXPECT_TRUE(json["identifiability"]["condition"].is_null());
  EXPECT_TRUE(json["lights"][0]["inverse_distance_sigma"].is_null());
  EXPECT_THAT(Codes(json), HasSubstr("null-condition"));
  EXPECT_THAT(json["notes"].dump(), HasSubstr("sigma of lights/0/inverse_distance_sigma."));
}

TEST(ResultJson, ReadsBackAsTheSameScene) {
  estimator::Estimate e = Example();
  e.reflectance.diffuse_model = estimator::model::DiffuseModel::kOrenNayar;
  e.reflectance.roughness = DegToRad(20.0);
  e.reflectance.ambient = 1.0 / 3.0;
  e.lights[1].light.color = {1.0, 0.9, 0.7};
  const auto scene = rig::sim::ParseScene(ToJson(e).dump(1), "result.json");
  ASSERT_TRUE(scene) << scene.error().text;
  ASSERT_EQ(scene->lights.size(), 2u);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(scene->lights[i].direction, e.lights[i].light.direction);
    EXPECT_EQ(scene->lights[i].inverse_distance, e.lights[i].light.inverse_distance);
    EXPECT_EQ(scene->lights[i].intensity, e.lights[i].light.intensity);
    EXPECT_EQ(scene->lights[i].color, e.lights[i].light.color);
  }
  EXPECT_EQ(scene->reflectance.albedo, e.reflectance.albedo);
  EXPECT_EQ(scene->reflectance.ambient, e.reflectance.ambient);
  EXPECT_EQ(scene->reflectance.shininess, e.reflectance.shininess);
  EXPECT_NEAR(scene->reflectance.roughness, e.reflectance.roughness, 1e-15);
}

TEST(ResultJson, LobeWidthIsWhereTheLobeHalves) {
  estimator::model::Reflectance phong;
  phong.shininess = 40.0;
  const double half = DegToRad(LobeWidthDeg(phong) / 2.0);
  EXPECT_NEAR(std::pow(std::cos(half), 40.0), 0.5, 1e-12);
  estimator::model::Reflectance blinn = phong;
  blinn.specular_model = estimator::model::SpecularModel::kBlinnPhong;
  EXPECT_DOUBLE_EQ(LobeWidthDeg(blinn), 2.0 * LobeWidthDeg(phong));
}

TEST(Summary, RoundsToTheSigma) {
  EXPECT_EQ(Measure(700.1234, 1.24), "700.1 \u00b1 1.2");
  EXPECT_EQ(Measure(0.123456, 0.00045), "0.12346 \u00b1 0.00045");
  EXPECT_EQ(Measure(1234.5, 56.0), "1234 \u00b1 56");
  EXPECT_EQ(Measure(0.5, 0.0), "0.5");
  EXPECT_EQ(Measure(0.5, std::numeric_limits<double>::infinity()), "0.5");
}

TEST(Summary, SaysWhatWasFound) {
  const std::string text = Summary(Example(), "ball", "mm");
  EXPECT_THAT(text, HasSubstr("ball: 36 views, 4321 pixels"));
  EXPECT_THAT(text, HasSubstr("2 lights (1 near, 1 distant), Lambert + Phong"));
  EXPECT_THAT(text, HasSubstr("distance 700.0 \u00b1 1.2 mm"));
  EXPECT_THAT(text, HasSubstr("beyond 9e+03 mm, 95 %"));
  EXPECT_THAT(text, HasSubstr("shininess 40.00 \u00b1 0.40"));
  EXPECT_THAT(text, HasSubstr("one more light: it explains"));
  EXPECT_THAT(text, HasSubstr("views-add-nothing"));
}

}  // namespace
}  // namespace turnlight::app
