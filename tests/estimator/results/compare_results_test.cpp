// Proves, on results written by hand: which quantity is found different, by how many sigmas, and
// that nothing else is; partners by direction; models, and the gauge. Does not prove how often
// chance alone makes two results different; docs/compare.md has that, measured.
#include "estimator/results/compare_results.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>

#include "base/angles.h"

namespace turnlight::estimator::results {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

ReportedLight LightAt(double azimuth_deg, double intensity) {
  ReportedLight light;
  light.near = true;
  const double azimuth = DegToRad(azimuth_deg);
  light.direction = Eigen::Vector3d(0.6 * std::cos(azimuth), 0.6 * std::sin(azimuth), 0.8);
  light.direction_sigma_deg = 0.03;
  light.inverse_distance = {1.0 / 800.0, 2e-6};
  light.distance = {800.0, 1.2};
  light.intensity = {intensity, intensity == 1.0 ? std::nullopt : std::optional(0.01)};
  for (MeasuredValue& channel : light.diffuse_product) channel = {0.5 * intensity, 0.001};
  light.specular_product = {0.2 * intensity, 0.002};
  return light;
}

ReportedResult ExampleReported() {
  ReportedResult result;
  result.method = "lm";
  result.diffuse_model = "lambert";
  result.specular_model = "phong";
  result.albedo_model = "uniform";
  result.lights = {LightAt(0.0, 1.0), LightAt(90.0, 0.95), LightAt(200.0, 0.3)};
  result.albedo = {{{1.0, 0.0}, {0.7, 0.001}, {0.4, 0.001}}};
  result.ambient = {0.1, 0.001};
  result.diffuse = {0.5, 0.002};
  result.specular = {0.2, 0.002};
  result.shininess = {40.0, 0.3};
  result.ambient_product = {{{0.1, 0.001}, {0.07, 0.001}, {0.04, 0.001}}};
  result.rms = 0.005;
  return result;
}

// With all that few results have: lights that change, two lobes, harmonics, colours.
ReportedResult RichReported() {
  ReportedResult result = ExampleReported();
  for (ReportedLight& light : result.lights)
    for (const std::size_t frame : {0, 5, 10})
      light.factors.push_back({frame, {1.0 + 0.01 * static_cast<double>(frame % 3), 0.002}});
  result.second_lobe = ReportedLobe{"ggx", {0.05, 0.001}, {}, {0.3, 0.01}, {0.5, 0.02}};
  result.ambient_harmonics.assign(8, {0.01, 0.001});
  result.diffuse_harmonics.assign(8, {0.05, {}});
  result.ambient_colour = result.specular_colour = {{{1.0, 0.0}, {0.9, 0.01}, {0.8, 0.01}}};
  return result;
}

Comparison Compared(const ReportedResult& a, const ReportedResult& b,
                    Tolerances tolerances = StandardTolerances(ResultQuantities())) {
  return CompareResults(a, b, tolerances);
}

std::vector<std::string> NamesOf(const Comparison& comparison, Verdict verdict) {
  std::vector<std::string> names;
  for (const ComparedQuantity& quantity : comparison.quantities)
    if (quantity.verdict == verdict) names.push_back(quantity.group + ": " + quantity.name);
  return names;
}

const ComparedQuantity& Named(const Comparison& comparison, const std::string& name) {
  return *std::find_if(comparison.quantities.begin(), comparison.quantities.end(),
                       [&](const ComparedQuantity& q) { return q.group + ": " + q.name == name; });
}

TEST(CompareResults, AResultIsTheSameAsItself) {
  const Comparison comparison = Compared(ExampleReported(), ExampleReported());
  EXPECT_TRUE(comparison.Same());
  EXPECT_THAT(NamesOf(comparison, Verdict::kNotJudged), IsEmpty());
  EXPECT_EQ(comparison.quantities.size(), 5U + 3U * 12U + 12U);
}

TEST(CompareResults, OneQuantityIsFoundAndNamed) {
  ReportedResult b = ExampleReported();
  b.lights[1].distance.value = 800.0 + 4.0 * std::hypot(1.2, 1.2);
  const Comparison comparison = Compared(ExampleReported(), b);
  EXPECT_THAT(NamesOf(comparison, Verdict::kDifferent), ElementsAre("light 2: distance"));
  EXPECT_NEAR(*Named(comparison, "light 2: distance").sigmas, 4.0, 1e-9);
  Tolerances tolerances = StandardTolerances(ResultQuantities());
  tolerances.quantities["distance"] = {.relative = 0.01};
  EXPECT_TRUE(Compared(ExampleReported(), b, tolerances).Same());
}

TEST(CompareResults, EveryQuantityCounts) {
  const std::vector<std::pair<std::string, std::function<void(ReportedResult&)>>> changes{
      {"model: method", [](auto& r) { r.method = "paper"; }},
      {"model: specular model", [](auto& r) { r.specular_model = "none"; }},
      {"model: diffuse model", [](auto& r) { r.diffuse_model = "oren-nayar"; }},
      {"light 3: kind", [](auto& r) { r.lights[2].near = false; }},
      {"light 3: inverse distance", [](auto& r) { r.lights[2].inverse_distance.value = 0.0013; }},
      {"light 3: intensity", [](auto& r) { r.lights[2].intensity.value = 0.35; }},
      {"light 3: distance", [](auto& r) { r.lights[2].distance = {}; }},
      {"light 3: colour, green",
       [](auto& r) {
         r.lights[2].colour = {1.0, 0.9, 1.0};
       }},
      {"light 3: diffuse product, blue",
       [](auto& r) { r.lights[2].diffuse_product[2].value = 0.2; }},
      {"light 3: specular product", [](auto& r) { r.lights[2].specular_product.value = 0.1; }},
      {"reflectance: albedo, green", [](auto& r) { r.albedo[1].value = 0.71; }},
      {"reflectance: ambient", [](auto& r) { r.ambient.value = 0.11; }},
      {"reflectance: diffuse", [](auto& r) { r.diffuse.value = 0.52; }},
      {"reflectance: specular", [](auto& r) { r.specular.value = 0.22; }},
      {"reflectance: shininess", [](auto& r) { r.shininess.value = 42.0; }},
      {"reflectance: alpha",
       [](auto& r) {
         r.alpha = {0.2, 0.001};
       }},
      {"reflectance: F0",
       [](auto& r) {
         r.f0 = {0.5, 0.001};
       }},
      {"reflectance: roughness", [](auto& r) { r.roughness_deg.value = 10.0; }},
      {"reflectance: ambient product, red", [](auto& r) { r.ambient_product[0].value = 0.11; }},
      {"residual: rms", [](auto& r) { r.rms = 0.0054; }}};
  for (const auto& [name, change] : changes) {
    ReportedResult b = ExampleReported();
    change(b);
    EXPECT_THAT(NamesOf(Compared(ExampleReported(), b), Verdict::kDifferent), ElementsAre(name));
    EXPECT_THAT(NamesOf(Compared(b, ExampleReported()), Verdict::kDifferent), ElementsAre(name));
  }
}

TEST(CompareResults, EveryRareQuantityCounts) {
  const ReportedResult a = RichReported();
  EXPECT_TRUE(Compared(a, a).Same());
  EXPECT_EQ(Compared(a, a).quantities.size(), 5U + 3U * (12U + 3U) + 12U + 4U + 8U + 8U + 6U);
  const std::vector<std::pair<std::string, std::function<void(ReportedResult&)>>> changes{
      {"light 2: factor in frame 5", [](auto& r) { r.lights[1].factors[1].factor.value = 1.06; }},
      {"light 2: factor in frame 10", [](auto& r) { r.lights[1].factors[2].factor = {}; }},
      {"light 2: factor in frame 10", [](auto& r) { r.lights[1].factors.pop_back(); }},
      {"light 2: change from frame to frame", [](auto& r) { r.lights[1].factors.clear(); }},
      {"reflectance: second lobe", [](auto& r) { r.second_lobe.reset(); }},
      {"reflectance: model of the second lobe", [](auto& r) { r.second_lobe->model = "phong"; }},
      {"reflectance: specular of the second lobe",
       [](auto& r) { r.second_lobe->specular.value = 0.06; }},
      {"reflectance: alpha of the second lobe", [](auto& r) { r.second_lobe->alpha.value = 0.36; }},
      {"reflectance: F0 of the second lobe", [](auto& r) { r.second_lobe->f0.value = 0.6; }},
      {"reflectance: ambient harmonic 3", [](auto& r) { r.ambient_harmonics[2].value = 0.015; }},
      {"reflectance: ambient harmonics", [](auto& r) { r.ambient_harmonics.clear(); }},
      {"reflectance: diffuse harmonic 8", [](auto& r) { r.diffuse_harmonics[7].value = 0.16; }},
      {"reflectance: diffuse harmonics", [](auto& r) { r.diffuse_harmonics.clear(); }},
      {"reflectance: ambient colour, blue", [](auto& r) { (*r.ambient_colour)[2].value = 0.9; }},
      {"reflectance: specular colour", [](auto& r) { r.specular_colour.reset(); }}};
  for (const auto& [name, change] : changes) {
    ReportedResult b = RichReported();
    change(b);
    EXPECT_THAT(NamesOf(Compared(a, b), Verdict::kDifferent), ElementsAre(name));
    EXPECT_THAT(NamesOf(Compared(b, a), Verdict::kDifferent), ElementsAre(name));
  }
}

TEST(CompareResults, FactorsAreOfTheSameFrameByTheirSigmas) {
  const ReportedResult a = RichReported();
  ReportedResult b = RichReported();
  std::swap(b.lights[0].factors[0], b.lights[0].factors[2]);
  EXPECT_TRUE(Compared(a, b).Same()) << "whatever their order";
  b.lights[0].factors[1].factor.value = 1.02 + 4.0 * std::hypot(0.002, 0.002);
  EXPECT_NEAR(*Named(Compared(a, b), "light 1: factor in frame 5").sigmas, 4.0, 1e-9);
  Tolerances tolerances = StandardTolerances(ResultQuantities());
  tolerances.quantities["factor"] = {.absolute = 0.02};
  EXPECT_TRUE(Compared(a, b, tolerances).Same());
}

TEST(CompareResults, WhatHasNoSigmaHasAToleranceOfItsOwn) {
  ReportedResult b = RichReported();
  b.diffuse_harmonics[0].value = 0.14;
  EXPECT_TRUE(Compared(RichReported(), b).Same());
  Tolerances strict = StandardTolerances(ResultQuantities());
  strict.quantities["diffuse_harmonics"] = {.absolute = 0.001};
  EXPECT_FALSE(Compared(RichReported(), b, strict).Same());
}

TEST(CompareResults, DirectionsByTheirAngle) {
  ReportedResult b = ExampleReported();
  const Eigen::AngleAxisd turn(DegToRad(0.2), b.lights[0].direction.unitOrthogonal());
  b.lights[0].direction = turn * b.lights[0].direction;
  const Comparison comparison = Compared(ExampleReported(), b);
  EXPECT_THAT(NamesOf(comparison, Verdict::kDifferent), ElementsAre("light 1: direction"));
  EXPECT_NEAR(*Named(comparison, "light 1: direction").difference, 0.2, 1e-9);
  EXPECT_NEAR(*Named(comparison, "light 1: direction").sigmas, 0.2 / std::hypot(0.03, 0.03), 1e-6);
}

TEST(CompareResults, LightsArePartnersByDirectionNotByOrder) {
  ReportedResult b = ExampleReported();
  std::swap(b.lights[1], b.lights[2]);
  EXPECT_TRUE(Compared(ExampleReported(), b).Same());
  // Greedily the nearest pair, 10 degrees, would leave 40 to the others; together 15 + 15 is less.
  const std::vector<ReportedLight> a{LightAt(0.0, 1.0), LightAt(25.0, 1.0)};
  const std::vector<ReportedLight> shifted{LightAt(15.0, 1.0), LightAt(40.0, 1.0)};
  EXPECT_THAT(PartnersByDirection(a, shifted), ElementsAre(0U, 1U));
}

TEST(CompareResults, TheAssignmentIsTheBestOfAll) {
  for (int seed = 0; seed < 50; ++seed) {
    std::vector<ReportedLight> a, b;
    for (int i = 0; i < 5; ++i) {
      a.push_back(LightAt(std::fmod(137.5 * (seed + 1) * (i + 1), 360.0), 1.0));
      b.push_back(LightAt(std::fmod(71.3 * (seed + 2) * (i + 3), 360.0), 1.0));
    }
    const auto cost = [&](std::size_t i, std::size_t j) {
      return std::acos(std::clamp(a[i].direction.dot(b[j].direction), -1.0, 1.0));
    };
    std::vector<std::size_t> order{0, 1, 2, 3, 4};
    double best = 1e9;
    do {
      double sum = 0.0;
      for (std::size_t i = 0; i < order.size(); ++i) sum += cost(i, order[i]);
      best = std::min(best, sum);
    } while (std::next_permutation(order.begin(), order.end()));
    double found = 0.0;
    const auto partners = PartnersByDirection(a, b);
    for (std::size_t i = 0; i < a.size(); ++i) found += cost(i, *partners[i]);
    EXPECT_NEAR(found, best, 1e-9) << seed;
  }
}

TEST(CompareResults, ALightThatIsMissingIsNamed) {
  ReportedResult b = ExampleReported();
  b.lights.erase(b.lights.begin() + 1);
  EXPECT_THAT(NamesOf(Compared(ExampleReported(), b), Verdict::kDifferent),
              ElementsAre("model: lights", "light 2: direction"));
  const Comparison other = Compared(b, ExampleReported());
  EXPECT_THAT(NamesOf(other, Verdict::kDifferent),
              ElementsAre("model: lights", "light 2 of B: direction"));
  EXPECT_THAT(Named(other, "light 2 of B: direction").why, HasSubstr("in B only"));
  b.lights.clear();
  EXPECT_FALSE(Compared(ExampleReported(), b).Same());
  EXPECT_TRUE(Compared(b, b).Same());
}

// Two lights nearly as strong, the other being the strongest in B: what is relative to it cannot be
// judged, and is not scored as the same.
TEST(CompareResults, AnotherGauge) {
  ReportedResult b = ExampleReported();
  std::swap(b.lights[0], b.lights[1]);
  b.lights[0].intensity = {1.0, {}};
  b.lights[1].intensity = {0.99, 0.01};
  b.diffuse.value = 0.45;
  const Comparison comparison = Compared(ExampleReported(), b);
  EXPECT_TRUE(comparison.Same());
  EXPECT_EQ(NamesOf(comparison, Verdict::kNotJudged).size(), 3U + 6U);
  EXPECT_THAT(Named(comparison, "reflectance: diffuse").why, HasSubstr("the products judge it"));
  b.lights[0].diffuse_product[0].value = 0.6;
  EXPECT_THAT(NamesOf(Compared(ExampleReported(), b), Verdict::kDifferent),
              ElementsAre("light 2 (1 of B): diffuse product, red"));
}

TEST(CompareResults, WhatHangsOnTheGaugeAmongTheRare) {
  ReportedResult b = RichReported();
  std::swap(b.lights[0], b.lights[1]);
  b.lights[0].intensity = {1.0, {}};
  b.lights[1].intensity = {0.99, 0.01};
  const auto unjudged = NamesOf(Compared(RichReported(), b), Verdict::kNotJudged);
  EXPECT_EQ(unjudged.size(), 3U + 6U + 1U + 8U);
  EXPECT_THAT(unjudged, testing::Contains("reflectance: specular of the second lobe"));
  EXPECT_THAT(unjudged, testing::Contains("reflectance: ambient harmonic 1"));
}

TEST(CompareResults, AnotherBrightestChannel) {
  ReportedResult b = ExampleReported();
  b.albedo = {{{0.99, 0.001}, {1.0, 0.0}, {0.4, 0.001}}};
  EXPECT_EQ(NamesOf(Compared(ExampleReported(), b), Verdict::kNotJudged).size(), 3U + 6U);
}

}  // namespace
}  // namespace turnlight::estimator::results
