// Proves: what ResultToJson writes is read back as values, nulls as not known; what is no result is
// refused in words. Does not prove what the numbers mean.
#include "estimator/results/reported_result.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <tuple>

#include "estimator/results/result_json.h"
#include "tests/estimator/results/example_estimate.h"

namespace turnlight::estimator::results {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

json ExampleResult() {
  return json::parse(ResultToJson(ExampleEstimate(), "s", Method::kLeastSquares, {}));
}

TEST(ReportedResult, TheFirstLobesAlphaAndColours) {
  Estimate e = ExampleEstimate();
  e.reflectance.lobes[0] = {model::SpecularModel::kGgx, 0.3, 0.2, 0.5};
  e.sigma.lobes[0] = {0.01, 0.002, 0.03};
  e.lights[1].light.color = {1.0, 0.9, 0.7};
  e.lights[1].colour_sigma = {0.0, 0.01, 0.02};
  const auto read =
      ParseReportedResult(ResultToJson(e, "n", Method::kLeastSquares, {}), "result.json");
  ASSERT_TRUE(read) << read.error().text;
  EXPECT_EQ(read->alpha.value, 0.2);
  EXPECT_EQ(read->alpha.sigma, 0.002);
  EXPECT_EQ(read->f0.sigma, 0.03);
  EXPECT_EQ(read->shininess.value, std::nullopt);
  EXPECT_EQ(read->lights[1].colour_sigma[2], 0.02);
}

TEST(ReportedResult, WhatFewResultsHave) {
  Estimate e = ExampleEstimate();
  e.reflectance.lobes = {model::Lobe{model::SpecularModel::kPhong, 0.3, 90.0},
                         model::Lobe{model::SpecularModel::kGgx, 0.1, 0.4, 0.7}};
  e.sigma.lobes[1] = {0.01, 0.002, 0.03};
  e.reflectance.harmonics[2] = 0.04;
  e.sigma.harmonics[2] = 0.005;
  e.reflectance.shading[7] = -0.02;
  e.reflectance.ambient_colour = {1.0, 0.9, 0.8};
  e.sigma.ambient_colour = {0.0, 0.01, 0.02};
  e.lights[1].light.factors = {1.0, 0.9, 1.1};
  e.lights[1].factor_sigma = {0.01, std::numeric_limits<double>::quiet_NaN(), 0.02};
  e.frames = {0, 2, 7};
  const auto read =
      ParseReportedResult(ResultToJson(e, "n", Method::kLeastSquares, {}), "result.json");
  ASSERT_TRUE(read) << read.error().text;
  ASSERT_TRUE(read->second_lobe);
  EXPECT_EQ(read->second_lobe->model, "ggx");
  EXPECT_EQ(read->second_lobe->specular.value, 0.1);
  EXPECT_EQ(read->second_lobe->alpha.sigma, 0.002);
  EXPECT_EQ(read->second_lobe->f0.value, 0.7);
  EXPECT_FALSE(read->second_lobe->shininess.value);
  EXPECT_FALSE(read->alpha.value) << "of the first";
  ASSERT_EQ(read->ambient_harmonics.size(), 8U);
  EXPECT_EQ(read->ambient_harmonics[2].sigma, 0.005);
  ASSERT_EQ(read->diffuse_harmonics.size(), 8U);
  EXPECT_EQ(read->diffuse_harmonics[7].value, -0.02);
  EXPECT_FALSE(read->diffuse_harmonics[7].sigma);
  EXPECT_EQ((*read->ambient_colour)[2].sigma, 0.02);
  EXPECT_FALSE(read->specular_colour);
  EXPECT_TRUE(read->lights[0].factors.empty());
  const auto& factors = read->lights[1].factors;
  ASSERT_EQ(factors.size(), 3U);
  EXPECT_EQ(factors[2].frame, 7U);
  EXPECT_EQ(factors[2].factor.value, 1.1);
  EXPECT_EQ(factors[2].factor.sigma, 0.02);
  EXPECT_FALSE(factors[1].factor.value) << "a frame that does not see the light";
}

// Of a result that does not say which frames its factors are of they count as they come.
TEST(ReportedResult, FactorsWithoutFrames) {
  json result = ExampleResult();
  result["lights"][0]["factors"] = {0.9, 1.1};
  const auto read = ParseReportedResult(result.dump(), "r");
  ASSERT_TRUE(read) << read.error().text;
  EXPECT_EQ(read->lights[0].factors[1].frame, 1U);
  EXPECT_EQ(read->lights[0].factors[1].factor.value, 1.1);
}

TEST(ReportedResult, ListsThatDoNotFitAreRefused) {
  const std::vector<std::tuple<json::json_pointer, json, std::string>> changes{
      {json::json_pointer("/frames"), {0, -1}, "a list of numbers of frames"},
      {json::json_pointer("/frames"), 3, "a list of numbers of frames"},
      {json::json_pointer("/frames"), {0, 1, 2}, "one element for each of frames"},
      {json::json_pointer("/lights/0/factors_sigma"), {0.1}, "one element for each of factors"},
      {json::json_pointer("/lights/0/factors"), {1.0, "x"}, "a list of numbers or nulls"},
      {json::json_pointer("/reflectance/ambient_harmonics"), 1, "a list of numbers or nulls"},
      {json::json_pointer("/reflectance/lobes"), {{{"model", "ggx"}}}, "lobes/0/sigma"}};
  for (const auto& [at, value, message] : changes) {
    json result = ExampleResult();
    result["lights"][0]["factors"] = {0.9, 1.1};
    result[at] = value;
    const auto read = ParseReportedResult(result.dump(), "r.json");
    ASSERT_FALSE(read) << at.to_string();
    EXPECT_THAT(read.error().text, AllOf(HasSubstr("r.json"), HasSubstr(message)));
  }
}

TEST(ReportedResult, WhatIsWrittenIsRead) {
  const auto read = ParseReportedResult(ExampleResult().dump(), "result.json");
  ASSERT_TRUE(read) << read.error().text;
  EXPECT_EQ(read->method, "lm");
  ASSERT_EQ(read->lights.size(), 2U);
  const ReportedLight& near = read->lights[0];
  EXPECT_TRUE(near.near);
  EXPECT_NEAR(*near.direction_sigma_deg, 0.012, 1e-12);
  EXPECT_EQ(near.distance.value, 700.0);
  EXPECT_EQ(near.distance.sigma, 1.24);
  EXPECT_EQ(near.intensity.value, 1.0);
  EXPECT_FALSE(near.intensity.sigma);
  EXPECT_EQ(near.diffuse_product[1].value, 0.2);
  EXPECT_EQ(near.specular_product.value, 0.35);
  EXPECT_FALSE(read->lights[1].near);
  EXPECT_FALSE(read->lights[1].distance.value);
  EXPECT_EQ(read->albedo[0].value, 0.4);
  EXPECT_EQ(read->shininess.sigma, 0.4);
  EXPECT_FALSE(read->roughness_deg.value);
}

TEST(ReportedResult, NewKeysArePassedOver) {
  json result = ExampleResult();
  result["sigma"] = {{"budget", 1}};
  result["lights"][0]["extent"] = 3;
  EXPECT_TRUE(ParseReportedResult(result.dump(), "r"));
}

TEST(ReportedResult, Refusals) {
  const std::vector<std::pair<json, std::string>> changes{
      {{{"format", "turnlight-session"}}, "turnlight-result"},
      {{{"version", 2}}, "version"},
      {{{"lights", 3}}, "lights"},
      {{{"lights", {{{"direction", {0, 0, 0}}}}}}, "it has no length"},
      {{{"lights", {{{"direction", {0, 0}}}}}}, "lights/0/direction"},
      {{{"lights", json::array()}}, "near"},
      {{{"model", {{"diffuse", "lambert"}}}}, "model/specular"},
      {{{"products", {{"diffuse", {{1, 2}}}}}}, "one element for each light"},
      {{{"reflectance", {{"albedo", {1, "x", 2}}, {"sigma", json::object()}}}},
       "a list of 3 numbers or nulls"},
      {{{"reflectance", {{"albedo", 1}, {"sigma", json::object()}}}},
       "a list of 3 numbers or nulls"},
      {{{"residual", json::object()}}, "residual/rms"}};
  for (const auto& [change, message] : changes) {
    json result = ExampleResult();
    for (const auto& [key, value] : change.items()) result[key] = value;
    const auto read = ParseReportedResult(result.dump(), "r.json");
    ASSERT_FALSE(read) << change;
    EXPECT_THAT(read.error().text, AllOf(HasSubstr("r.json"), HasSubstr(message)));
  }
  json lame = ExampleResult();
  lame["model"]["near"] = {true, 1};
  EXPECT_FALSE(ParseReportedResult(lame.dump(), "r.json"));
  EXPECT_FALSE(ParseReportedResult("{", "r.json"));
  EXPECT_FALSE(ParseReportedResult("[]", "r.json"));
}

}  // namespace
}  // namespace turnlight::estimator::results
