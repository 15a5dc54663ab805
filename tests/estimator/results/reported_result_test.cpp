// Proves: what ResultToJson writes is read back as values, nulls as not known; what is no result is
// refused in words. Does not prove what the numbers mean.
#include "estimator/results/reported_result.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

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
