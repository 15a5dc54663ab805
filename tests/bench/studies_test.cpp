// Proves that the study harness measures what it says: lights are matched with their truth, errors
// and sigmas come from where they stand, bands are those of the binomial distribution, scenes are
// what their generator promises, a crash or a hang of a scene is a record, and a run goes on where
// it was stopped. Does not prove: anything about the estimator (study_slice_test.cpp does a little,
// the full studies the rest).
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <filesystem>

#include "base/angles.h"
#include "base/file.h"
#include "base/statistics.h"
#include "bench/studies/job_runner.h"
#include "bench/studies/random_scene.h"
#include "bench/studies/report.h"
#include "bench/studies/score.h"
#include "bench/studies/seen.h"
#include "bench/studies/statistics.h"
#include "bench/studies/summary.h"

namespace turnlight::studies {
namespace {

using Eigen::Vector3d;

std::filesystem::path Scratch(const std::string& name) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("studies_test_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  return folder / name;
}

TEST(Band, IsTheBinomialTable) {
  // Tables: P(X <= 5) = 0.0207, P(X <= 6) = 0.0577 for 20 trials at one half.
  EXPECT_EQ(BinomialBand(20, 0.5, 0.95).low, 6);
  EXPECT_EQ(BinomialBand(20, 0.5, 0.95).high, 14);
  // P(X <= 15) = 0.0026, P(X <= 16) = 0.0159 for 20 trials at 0.95; P(X <= 19) = 0.6415.
  EXPECT_EQ(BinomialBand(20, 0.95, 0.99).low, 16);
  EXPECT_EQ(BinomialBand(20, 0.95, 0.99).high, 20);
}

TEST(QuantileOf, LiesBetweenOrderStatistics) {
  EXPECT_EQ(InterpolatedQuantile({3.0, 1.0, 2.0}, 0.5), 2.0);
  EXPECT_EQ(InterpolatedQuantile({0.0, 1.0}, 0.25), 0.25);
  EXPECT_EQ(InterpolatedQuantile({1.0, 1.0, INFINITY, INFINITY}, 1.0), INFINITY);
  EXPECT_TRUE(std::isnan(InterpolatedQuantile({}, 0.5)));
}

TEST(Matching, PairsTheNearestAndLeavesTheRest) {
  const std::vector<Vector3d> truth = {Vector3d::UnitX(), Vector3d::UnitY()};
  const Vector3d near_y = Vector3d(0.1, 1.0, 0.0).normalized();
  const auto matches = MatchLights(truth, {near_y, Vector3d::UnitX(), Vector3d::UnitZ()});
  ASSERT_EQ(matches.size(), 2u);
  EXPECT_EQ(matches[0].truth, 0u);
  EXPECT_EQ(matches[0].found, 1u);
  EXPECT_EQ(matches[1].truth, 1u);
  EXPECT_EQ(matches[1].found, 0u);
  EXPECT_NEAR(matches[1].angle_deg, RadToDeg(std::atan(0.1)), 1e-12);
}

// One light, straight up in the truth and 0.1 degree off in the result.
Json SmallResult() {
  const double off = DegToRad(0.1);
  Json light{{"direction", {std::sin(off), 0.0, std::cos(off)}},
             {"direction_sigma_deg", 0.05},
             {"inverse_distance", 0.0021},
             {"inverse_distance_sigma", nullptr},
             {"distance", nullptr},
             {"distance_sigma", nullptr}};
  Json products;
  products["diffuse"] = Json::array({{0.33, 0.4, 0.5}});
  products["diffuse_sigma"] = Json::array({{0.01, 0.01, 0.01}});
  products["ambient"] = {0.1, 0.1, 0.1};
  products["ambient_sigma"] = {0.01, 0.01, 0.01};
  products["specular"] = {0.3};
  products["specular_sigma"] = {0.02};
  Json result;
  result["lights"] = Json::array({light});
  result["products"] = products;
  result["model"] = {{"diffuse", "lambert"}, {"specular", "phong"}};
  result["reflectance"] = {{"shininess", 44.0}, {"sigma", {{"shininess", 2.0}}}};
  result["notes"] = Json::array({{{"code", "grey"}, {"text", ""}}});
  result["identifiability"] = {{"weak", Json::array()}};
  result["residual"] = {{"rms", 0.01}, {"pixels", 10}};
  result["distinct_views"] = 1;
  result["iterations"] = 3;
  result["time_s"] = {{"total", 0.5}};
  return result;
}

estimator::model::Scene SmallTruth() {
  estimator::model::Scene truth;
  truth.lights.push_back({Vector3d::UnitZ(), 0.002, 2.0, Vector3d::Ones()});
  truth.reflectance.albedo = {0.6, 0.8, 1.0};
  truth.reflectance.ambient = 0.1;
  truth.reflectance.diffuse = 0.25;
  truth.reflectance.lobes[0].strength = 0.2;
  truth.reflectance.lobes[0].shape = 40.0;
  return truth;
}

const Quantity* Find(const std::vector<Quantity>& quantities, const std::string& name) {
  for (const Quantity& quantity : quantities)
    if (quantity.name == name) return &quantity;
  return nullptr;
}

TEST(Scoring, TakesErrorsAndSigmasFromTheResult) {
  const Json record = Score(SmallTruth(), SmallResult());
  EXPECT_TRUE(record["right"].get<bool>());
  EXPECT_NEAR(record["angles_deg"][0].get<double>(), 0.1, 1e-9);
  EXPECT_EQ(record["notes"], Json::array({"grey"}));
  std::vector<Quantity> quantities;
  for (const Json& json : record["quantities"]) quantities.push_back(QuantityFromJson(json));
  EXPECT_NEAR(Find(quantities, "direction")->ErrorInSigmas().value(), 2.0, 1e-9);
  EXPECT_NEAR(Find(quantities, "diffuse_r")->truth, 0.6 * 0.25 * 2.0, 1e-12);
  EXPECT_NEAR(Find(quantities, "diffuse_r")->ErrorInSigmas().value(), 3.0, 1e-9);
  EXPECT_NEAR(Find(quantities, "specular")->ErrorInSigmas().value(), 5.0, 1e-9);
  EXPECT_NEAR(Find(quantities, "shininess")->ErrorInSigmas().value(), 2.0, 1e-9);
  // Null in the result: not there, or without a sigma.
  EXPECT_EQ(Find(quantities, "distance"), nullptr);
  EXPECT_FALSE(Find(quantities, "inverse_distance")->ErrorInSigmas().has_value());
}

TEST(Scoring, ComparesNothingWithAnotherLightWhenTheCountIsWrong) {
  estimator::model::Scene truth = SmallTruth();
  truth.lights.front().direction = Vector3d::UnitX();
  truth.lights.push_back({Vector3d::UnitY(), 0.0, 1.0, Vector3d::Ones()});
  const Json record = Score(truth, SmallResult());
  EXPECT_FALSE(record["right"].get<bool>());
  for (const Json& json : record["quantities"]) EXPECT_EQ(QuantityFromJson(json).light, -1);
  // Unless that is wanted.
  EXPECT_EQ(Score(truth, SmallResult(), 180.0)["quantities"][0][0], "direction");
}

TEST(Running, ACrashAndAHangAreRecords) {
  const std::vector<Job> jobs = {{"a",
                                  [] {
                                    return Json{{"value", 1}};
                                  }},
                                 {"b",
                                  [] {
                                    std::raise(SIGKILL);
                                    return Json();
                                  }},
                                 {"c",
                                  [] {
                                    for (;;) pause();
                                    return Json();
                                  }},
                                 {"d", []() -> Json { _exit(7); }}};
  const auto file = RunJobs("trial", jobs, {.processes = 2, .deadline_s = 1.0, .out = {}});
  ASSERT_TRUE(file) << file.error().text;
  EXPECT_EQ(file->records.at("a")["value"], 1);
  EXPECT_THAT(file->records.at("b")["failed"].get<std::string>(), testing::HasSubstr("signal 9"));
  EXPECT_THAT(file->records.at("c")["failed"].get<std::string>(), testing::HasSubstr("after 1 s"));
  EXPECT_THAT(file->records.at("d")["failed"].get<std::string>(), testing::HasSubstr("code 7"));
}

TEST(Running, GoesOnWhereItWasStopped) {
  const std::filesystem::path out = Scratch("resume.json");
  const auto job = [](const std::string& id, int value) {
    return Job{id, [value] { return Json{{"value", value}}; }};
  };
  ASSERT_TRUE(RunJobs("trial", {job("a", 1)}, {.out = out}));
  const auto second = RunJobs("trial", {job("a", 2), job("b", 2)}, {.out = out});
  ASSERT_TRUE(second);
  EXPECT_EQ(second->records.at("a")["value"], 1);
  EXPECT_EQ(second->records.at("b")["value"], 2);
  const auto fresh = RunJobs("trial", {job("a", 3)}, {.out = out, .fresh = true});
  EXPECT_EQ(fresh->records.at("a")["value"], 3);
  EXPECT_EQ(ReadStudyFile(out)->records.size(), 2u);
  const auto other = RunJobs("another", {}, {.out = out});
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().text, testing::HasSubstr("holds the study \"trial\""));
}

TEST(Running, RefusesAFileThatIsNoStudy) {
  const std::filesystem::path path = Scratch("no_study.json");
  ASSERT_TRUE(WriteFileAtomic(path, "{\"format\": \"something\"}"));
  EXPECT_FALSE(ReadStudyFile(path));
}

TEST(RandomScenes, KeepWhatTheyPromise) {
  for (std::uint64_t number = 0; number < 4; ++number) {
    const auto config = RandomScene(number);
    ASSERT_TRUE(config) << config.error().text;
    const auto& lights = std::get<std::vector<rig::sim::LightSpec>>(config->lights);
    const auto& material = std::get<estimator::model::Reflectance>(config->reflectance);
    EXPECT_GE(material.lobes[0].shape, 20.0);
    const auto seen = SeenSurface::Build(*config);
    ASSERT_TRUE(seen);
    const double width = 2.0 * std::acos(std::exp2(-1.0 / material.lobes[0].shape));
    double weakest = INFINITY, strongest = 0.0;
    estimator::model::Scene scene{{}, material};
    for (const rig::sim::LightSpec& a : lights) {
      weakest = std::min(weakest, a.intensity);
      strongest = std::max(strongest, a.intensity);
      for (const rig::sim::LightSpec& b : lights)
        if (&a != &b) {
          EXPECT_GE(std::acos(a.direction.dot(b.direction)), 2.0 * width - 1e-9);
        }
      const estimator::model::Light light{a.direction, a.distance ? 1.0 / *a.distance : 0.0,
                                          a.intensity, a.color};
      EXPECT_GE(seen->ViewsOfHighlight(light, material.lobes[0].shape, 4), 2);
      scene.lights.push_back(light);
      EXPECT_GE(seen->HighlightPeak(scene, light), 0.05);
    }
    EXPECT_LE(strongest / weakest, 5.0);
    EXPECT_GE(seen->Brightest(scene), 0.69);
    EXPECT_EQ(rig::sim::ToYaml(*config), rig::sim::ToYaml(*RandomScene(number)));
  }
}

TEST(Seeing, AShadowedHighlightIsNotSeen) {
  // A deep lump on the table: from straight below nothing that the camera sees is lit.
  rig::sim::SyntheticConfig config;
  config.target = rig::sim::Blob{40.0, 0.25, 64};
  config.motion = {rig::sim::MotionKind::kTable, 3, 120.0, 420.0, 80.0, 0.0};
  config.camera = {80, 60, 130.0, std::nullopt};
  const auto seen = SeenSurface::Build(config);
  ASSERT_TRUE(seen);
  const estimator::model::Light above{Vector3d::UnitZ(), 0.0, 1.0, Vector3d::Ones()};
  const estimator::model::Light below{-Vector3d::UnitZ(), 0.0, 1.0, Vector3d::Ones()};
  EXPECT_EQ(seen->ViewsOfHighlight(above, 10.0, 4), 3);
  EXPECT_EQ(seen->ViewsOfHighlight(below, 10.0, 4), 0);
}

StudyFile SmallStudy() {
  Json right = Score(SmallTruth(), SmallResult());
  right["target"] = "sphere";
  right["id"] = "random/0000";
  estimator::model::Scene two = SmallTruth();
  two.lights.push_back({Vector3d::UnitY(), 0.0, 1.0, Vector3d::Ones()});
  Json wrong = Score(two, SmallResult());
  wrong["id"] = "random/0001";
  return {"random", {{"random/0000", right}, {"random/0001", wrong}}};
}

TEST(Summaries, CountWhatIsRight) {
  const Summary summary = Summarise(SmallStudy(), 5);
  EXPECT_FALSE(summary.accepted);
  EXPECT_THAT(summary.text, testing::HasSubstr("1 of 2 = 50.0 %, wanted 95 %"));
  EXPECT_THAT(summary.text, testing::HasSubstr("0 of 1 = 0.0 %, wanted 50 %"));
}

TEST(Reports, WriteThePageAndItsPlots) {
  const std::filesystem::path folder = Scratch("report");
  std::filesystem::create_directories(folder);
  ASSERT_TRUE(WriteStudyFile(SmallStudy(), folder / "random.json"));
  ASSERT_TRUE(WriteReport(folder, folder / "docs"));
  const auto page = ReadFile(folder / "docs" / "accuracy.md");
  ASSERT_TRUE(page);
  EXPECT_THAT(*page, testing::HasSubstr("1 of 2 = 50.0 %"));
  for (const char* plot : {"honesty.svg", "directions.svg", "counts.svg"})
    EXPECT_TRUE(std::filesystem::exists(folder / "docs" / "accuracy" / plot)) << plot;
}

}  // namespace
}  // namespace turnlight::studies
