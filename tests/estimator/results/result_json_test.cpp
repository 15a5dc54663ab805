// Proves that every value of an estimate lands under the design's key, that nothing unknown becomes
// a number, that a written result reads back as the scene that was estimated, and that the design
// lists every key that is written. Does not prove
// that the values are right; tests/estimator does.
#include "estimator/results/result_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "base/angles.h"
#include "estimator/results/scene_json.h"
#include "tests/estimator/results/example_estimate.h"

namespace turnlight::estimator::results {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

nlohmann::ordered_json ToJson(const Estimate& e) {
  return nlohmann::ordered_json::parse(ResultToJson(e, "name", Method::kLeastSquares, {0.5, 2.0}));
}

std::string Codes(const nlohmann::ordered_json& json) {
  std::string codes;
  for (const auto& note : json["notes"]) codes += note["code"].get<std::string>() + " ";
  return codes;
}

TEST(ResultJson, ValuesStandUnderTheirKeys) {
  const auto json = ToJson(ExampleEstimate());
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
  EXPECT_EQ(json["correlation"]["names"][0], "distance of light 1");
  EXPECT_EQ(json["correlation"]["matrix"][0][1], 0.25);
  EXPECT_FALSE(json["reflectance"].contains("roughness_deg"));
  EXPECT_EQ(json["time_s"]["total"], 2.0);
}

// Beside each stat, with its keys; items of nothing are left out.
TEST(ResultJson, TheBudgetStandsBesideStat) {
  Estimate e = ExampleEstimate();
  uncertainty::BudgetItem axis{{"axis", "axis of the table", "calibrate axis"}, {}};
  axis.sigma.lights.resize(2);
  axis.sigma.lights[0].direction = DegToRad(0.01);
  axis.sigma.lights[1].diffuse_product = {0.1, 0.2, 0.3};
  axis.sigma.lobes[0].shape = 0.25;
  e.budget = {axis};
  const auto json = ToJson(e);
  const auto& item = json["lights"][0]["budget"]["direction_sigma_deg"][0];
  EXPECT_EQ(item["item"], "axis");
  EXPECT_EQ(item["words"], "axis of the table");
  EXPECT_NEAR(item["sigma"].get<double>(), 0.01, 1e-12);
  EXPECT_TRUE(json["lights"][1]["budget"]["direction_sigma_deg"].empty());
  EXPECT_TRUE(json["lights"][1]["budget"]["distance_sigma"].is_null());
  EXPECT_EQ(json["products"]["budget"]["diffuse_sigma"][1][0]["sigma"],
            nlohmann::json({0.1, 0.2, 0.3}));
  EXPECT_EQ(json["reflectance"]["sigma"]["budget"]["shininess"][0]["sigma"], 0.25);
  for (const auto& [budget, stat] :
       {std::pair(json["lights"][0]["budget"], json["lights"][0]["stat"]),
        {json["reflectance"]["sigma"]["budget"], json["reflectance"]["sigma"]["stat"]},
        {json["products"]["budget"], json["products"]["stat"]}})
    for (const auto& [key, value] : stat.items()) EXPECT_TRUE(budget.contains(key)) << key;
}

// Frames are those of the factors: without factors there are none.
TEST(ResultJson, FactorsSayWhichFramesTheyAreOf) {
  Estimate e = ExampleEstimate();
  e.frames = {0, 2, 7};
  EXPECT_FALSE(ToJson(e).contains("frames"));
  e.lights[1].light.factors = {1.0, 0.9, 1.1};
  e.lights[1].factor_sigma = {0.01, 0.01, 0.02};
  EXPECT_EQ(ToJson(e)["frames"], nlohmann::json({0, 2, 7}));
}

TEST(ResultJson, WhatIsUnknownIsNullWithANote) {
  const auto json = ToJson(ExampleEstimate());
  EXPECT_TRUE(json["lights"][0]["intensity_sigma"].is_null());
  EXPECT_TRUE(json["lights"][1]["distance"].is_null());
  EXPECT_TRUE(json["lights"][1]["position"].is_null());
  EXPECT_THAT(Codes(json), HasSubstr("views-add-nothing"));
  EXPECT_THAT(Codes(json), HasSubstr("null-intensity-sigma"));
  EXPECT_THAT(Codes(json), Not(HasSubstr("null-distance-min")));
  EXPECT_THAT(Codes(json), Not(HasSubstr("null-sigma")));
}

TEST(ResultJson, WhatIsNotKnownIsNullAndItsSigmaStays) {
  Estimate estimate = ExampleEstimate();
  estimate.sigma.diffuse = 0.083;
  estimate.undetermined = {"reflectance/diffuse", "reflectance/albedo/1", "lights/1/intensity",
                           "products/diffuse/0/2", "reflectance/lobe/peak"};
  const auto json = ToJson(estimate);
  EXPECT_TRUE(json["reflectance"]["diffuse"].is_null());
  EXPECT_EQ(json["reflectance"]["sigma"]["diffuse"], 0.083);
  EXPECT_TRUE(json["reflectance"]["albedo"][1].is_null());
  EXPECT_EQ(json["reflectance"]["albedo"][2], 1.0);
  EXPECT_TRUE(json["reflectance"]["lobe"]["peak"].is_null());
  EXPECT_TRUE(json["lights"][1]["intensity"].is_null());
  EXPECT_TRUE(json["products"]["diffuse"][0][2].is_null());
  EXPECT_EQ(json["products"]["diffuse"][0][1], 0.2);
}

TEST(ResultJson, WithoutALobeThereIsNoShininess) {
  Estimate e = ExampleEstimate();
  e.reflectance.lobes[0].model = model::SpecularModel::kNone;
  e.sigma.lobes[0].shape.reset();
  const auto json = ToJson(e);
  EXPECT_TRUE(json["reflectance"]["shininess"].is_null());
  EXPECT_TRUE(json["reflectance"]["lobe"].is_null());
  EXPECT_EQ(json["reflectance"]["specular"], 0.0);
}

TEST(ResultJson, NoInfinityGetsOut) {
  Estimate e = ExampleEstimate();
  e.condition = std::numeric_limits<double>::infinity();
  e.lights[0].inverse_distance_sigma = std::numeric_limits<double>::quiet_NaN();
  const auto json = ToJson(e);
  EXPECT_TRUE(json["identifiability"]["condition"].is_null());
  EXPECT_TRUE(json["lights"][0]["inverse_distance_sigma"].is_null());
  EXPECT_THAT(Codes(json), HasSubstr("null-condition"));
  EXPECT_THAT(json["notes"].dump(), HasSubstr("sigma of lights/0/inverse_distance_sigma."));
}

TEST(ResultJson, ReadsBackAsTheSameScene) {
  Estimate e = ExampleEstimate();
  e.reflectance.diffuse_model = model::DiffuseModel::kOrenNayar;
  e.reflectance.roughness = DegToRad(20.0);
  e.reflectance.ambient = 1.0 / 3.0;
  e.lights[1].light.color = {1.0, 0.9, 0.7};
  const auto scene = ParseScene(ResultToJson(e, "name", Method::kPaper, {}), "result.json");
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
  EXPECT_EQ(scene->reflectance.lobes[0].shape, e.reflectance.lobes[0].shape);
  EXPECT_NEAR(scene->reflectance.roughness, e.reflectance.roughness, 1e-15);
}

TEST(ResultJson, LobeWidthIsWhereTheLobeHalves) {
  model::Reflectance phong;
  phong.lobes[0].shape = 40.0;
  const double half = DegToRad(LobeWidthDeg(phong.lobes[0]) / 2.0);
  EXPECT_NEAR(std::pow(std::cos(half), 40.0), 0.5, 1e-12);
  model::Reflectance blinn = phong;
  blinn.lobes[0].model = model::SpecularModel::kBlinnPhong;
  EXPECT_DOUBLE_EQ(LobeWidthDeg(blinn.lobes[0]), 2.0 * LobeWidthDeg(phong.lobes[0]));
}

void CollectKeys(const nlohmann::ordered_json& json, std::set<std::string>& keys) {
  for (const auto& [key, value] : json.items()) {
    if (json.is_object()) keys.insert(key);
    if (value.is_structured()) CollectKeys(value, keys);
  }
}

TEST(ResultJson, LobesAndColoursHaveTheirOwnKeys) {
  Estimate e = ExampleEstimate();
  EXPECT_FALSE(nlohmann::json::parse(ResultToJson(e, "n", Method::kLeastSquares, {}))["reflectance"]
                   .contains("lobes"));
  e.reflectance.lobes[0] = {model::SpecularModel::kGgx, 0.3, 0.2, 0.5};
  e.reflectance.lobes[1] = {model::SpecularModel::kPhong, 0.1, 12.0};
  e.sigma.lobes[0] = {0.01, 0.002, 0.03};
  e.reflectance.specular_colour = {1.0, 0.8, 0.6};
  e.sigma.specular_colour = {0.0, 0.01, 0.02};
  e.sigma.ambient_colour = {0.0, 0.01, 0.02};  // of a colour that is white
  e.lights[1].light.color = {1.0, 0.9, 0.7};
  e.lights[1].colour_sigma = {0.0, 0.01, 0.02};
  const std::string text = ResultToJson(e, "n", Method::kLeastSquares, {});
  const auto json = nlohmann::json::parse(text);
  const auto& r = json["reflectance"];
  EXPECT_TRUE(r["shininess"].is_null());
  ASSERT_EQ(r["lobes"].size(), 2u);
  EXPECT_EQ(r["lobes"][0]["model"], "ggx");
  EXPECT_EQ(r["lobes"][0]["alpha"], 0.2);
  EXPECT_EQ(r["lobes"][0]["f0"], 0.5);
  EXPECT_EQ(r["lobes"][0]["sigma"]["alpha"], 0.002);
  EXPECT_EQ(r["lobes"][1]["shininess"], 12.0);
  EXPECT_FALSE(r["lobes"][1].contains("f0"));
  EXPECT_EQ(r["sigma"]["specular_color"][2], 0.02);
  EXPECT_TRUE(r["sigma"]["stat"].contains("specular_color"));
  EXPECT_TRUE(r["sigma"]["budget"].contains("specular_color"));
  EXPECT_FALSE(r["sigma"].contains("ambient_color"));
  EXPECT_EQ(json["lights"][1]["color_sigma"][2], 0.02);
  EXPECT_FALSE(json["lights"][0].contains("color"));
  const auto scene = ParseScene(text, "result.json");
  ASSERT_TRUE(scene) << scene.error().text;
  EXPECT_EQ(scene->reflectance.lobes[0].f0, 0.5);
  EXPECT_EQ(scene->reflectance.lobes[1].shape, 12.0);
  EXPECT_EQ(scene->reflectance.specular_colour, e.reflectance.specular_colour);
}

TEST(ResultJson, TheDesignListsEveryKey) {
  Estimate e = ExampleEstimate();
  e.reflectance.diffuse_model = model::DiffuseModel::kOrenNayar;
  e.lights[1].light.color = {1.0, 0.9, 0.7};
  e.reflectance.lobes[0] = {model::SpecularModel::kGgx, 0.3, 0.2, 0.5};
  e.reflectance.ambient_colour = e.reflectance.specular_colour = {1.0, 0.8, 0.6};
  e.lights[0].light.factors = {1.0};
  e.frames = {0};
  std::set<std::string> keys;
  CollectKeys(nlohmann::ordered_json::parse(ResultToJson(e, "name", Method::kPaper, {})), keys);
  EXPECT_GT(keys.size(), 60u);
  std::ifstream file(std::string(TURNLIGHT_SOURCE_DIR) + "/docs/design.md");
  std::stringstream design;
  design << file.rdbuf();
  const std::string text = design.str();
  const std::string section = text.substr(text.find("\n## 8. "));
  for (const std::string& key : keys)
    EXPECT_TRUE(section.find('"' + key + '"') != std::string::npos ||
                section.find('`' + key + '`') != std::string::npos)
        << key;
}

TEST(ResultJson, EveryReasonToStopHasAWord) {
  for (const auto& [word, stopped] : Words<solve::Stopped>()) {
    Estimate e = ExampleEstimate();
    e.stopped = stopped;
    EXPECT_EQ(ToJson(e)["stopped"], word);
    EXPECT_EQ(ValueOf<solve::Stopped>(word), stopped);
  }
  EXPECT_EQ(ValueOf<solve::Stopped>("tired"), std::nullopt);
}

}  // namespace
}  // namespace turnlight::estimator::results
