// Proves what `estimate` as a program adds to the estimator: result.json as the design describes
// it, the same on standard output with --json, the same bytes (times aside) for any number of
// threads, the frames that --views takes, what --method paper writes, starts from files, and that a
// result can be rendered. Does not judge the estimate beyond "this is the light that was there";
// tests/estimator does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "tests/app/program.h"

namespace turnlight::app {
namespace {

using nlohmann::ordered_json;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

std::vector<std::string> Keys(const ordered_json& object) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.push_back(key);
  return keys;
}

class Estimate : public ::testing::Test {
 protected:
  void SetUp() override {
    rig::sim::SyntheticConfig config = SmallConfig();
    config.sensor.noise_relative = 0.003;
    WriteSession(config, folder_ / "s");
  }
  Outcome RunEstimate(const std::string& out, std::vector<std::string> more = {}) {
    std::vector<std::string> words{"estimate", folder_ / "s", "--out", folder_ / out};
    words.insert(words.end(), more.begin(), more.end());
    return RunProgram(words);
  }
  ordered_json Result(const std::string& out) {
    return ordered_json::parse(ReadText(folder_ / (out + "/result.json")));
  }
  TemporaryFolder folder_;
};

TEST_F(Estimate, WritesWhatTheDesignSays) {
  const Outcome outcome = RunEstimate("r", {"--json", "--no-pictures"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, ReadText(folder_ / "r/result.json"));
  const ordered_json json = ordered_json::parse(outcome.out);
  EXPECT_THAT(Keys(json), ElementsAre("format", "version", "session", "method", "reference_point",
                                      "model", "lights", "reflectance", "products", "correlation",
                                      "residual", "identifiability", "notes", "views",
                                      "distinct_views", "iterations", "stopped", "time_s"));
  EXPECT_EQ(json["format"], "turnlight-result");
  EXPECT_EQ(json["session"], "small");
  EXPECT_EQ(json["views"], 3);
  ASSERT_EQ(json["lights"].size(), 1u);
  const auto direction = json["lights"][0]["direction"].get<std::vector<double>>();
  const double length = std::hypot(0.4, 0.3, 0.85);
  EXPECT_NEAR(direction[0], 0.4 / length, 0.01);
  EXPECT_NEAR(direction[1], 0.3 / length, 0.01);
  EXPECT_EQ(json["lights"][0]["intensity"], 1.0);
  // Only result.json was asked for.
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder_ / "r"))
    ++files;
  EXPECT_EQ(files, 1u);
}

TEST_F(Estimate, TellsAPersonAndWritesPictures) {
  const Outcome outcome = RunEstimate("r");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("small: 3 views"));
  EXPECT_THAT(outcome.out, HasSubstr("light 1"));
  EXPECT_THAT(outcome.out, HasSubstr("result.json"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "r/comparison_000.png"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "r/correlation.png"));
  EXPECT_EQ(RunEstimate("r").exit_code, 0);  // over an old result
}

TEST_F(Estimate, SameBytesForAnyNumberOfThreads) {
  std::string first;
  for (const std::string threads : {"1", "2", "7", "7"}) {
    ASSERT_EQ(RunEstimate("r", {"--no-pictures", "--threads", threads}).exit_code, 0);
    ordered_json json = Result("r");
    json.erase("time_s");
    if (first.empty()) first = json.dump();
    EXPECT_EQ(json.dump(), first) << threads << " threads";
  }
}

TEST_F(Estimate, ViewsAreSpreadOverTheSession) {
  // Two of three frames are 0 and 1: frame 2 may be missing its picture's content.
  WriteText(folder_ / "s/frames/002.png", "not a picture");
  EXPECT_EQ(RunEstimate("r", {"--no-pictures", "--views", "3"}).exit_code, 2);
  ASSERT_EQ(RunEstimate("r", {"--no-pictures", "--views", "2"}).exit_code, 0);
  EXPECT_EQ(Result("r")["views"], 2);
  const Outcome too_many = RunEstimate("r", {"--views", "4"});
  EXPECT_EQ(too_many.exit_code, 2);
  EXPECT_THAT(too_many.err, HasSubstr("--views: 4"));
}

TEST_F(Estimate, StartsFromATruthAndFromAResult) {
  ASSERT_EQ(RunEstimate("a", {"--no-pictures", "--initial", folder_ / "s/truth.json"}).exit_code,
            0);
  ASSERT_EQ(RunEstimate("b", {"--no-pictures", "--initial", folder_ / "a/result.json"}).exit_code,
            0);
  EXPECT_EQ(Result("b")["lights"].size(), 1u);
  const Outcome missing = RunEstimate("c", {"--initial", folder_ / "none.json"});
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.err, HasSubstr("none.json"));
}

TEST_F(Estimate, AnUnusableOutputFolderIsToldBeforeTheWork) {
  WriteText(folder_ / "file", "x");
  const Outcome below = RunProgram({"estimate", folder_ / "s", "--out", folder_ / "file/r"});
  EXPECT_EQ(below.exit_code, 2);
  EXPECT_THAT(below.err, StartsWith("turnlight: --out: " + std::string(folder_ / "file") +
                                    " is a file, allowed is a folder"));
}

TEST_F(Estimate, AFolderThatMayNotBeWrittenIsToldBeforeTheWork) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  std::filesystem::create_directory(folder_ / "mine");
  std::filesystem::permissions(
      folder_ / "mine", std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  const Outcome denied = RunProgram({"estimate", folder_ / "s", "--out", folder_ / "mine/r"});
  EXPECT_EQ(denied.exit_code, 2);
  EXPECT_THAT(denied.err, StartsWith("turnlight: --out: "));
  EXPECT_THAT(denied.err, HasSubstr("cannot write in"));
}

TEST_F(Estimate, AResultCanBeRendered) {
  ASSERT_EQ(RunEstimate("r", {"--no-pictures"}).exit_code, 0);
  const Outcome outcome = RunProgram(
      {"render", folder_ / "s", "--params", folder_ / "r/result.json", "--out", folder_ / "relit"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST_F(Estimate, ByThePaper) {
  const Outcome outcome = RunEstimate("r", {"--method", "paper", "--ceiling-distance", "1.5"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("light 1"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("nan")));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "r/convergence.png"));
  const ordered_json json = Result("r");
  EXPECT_EQ(json["method"], "paper");
  const ordered_json& history = json["x-residual-history"];
  ASSERT_EQ(history.size(), json["iterations"].get<std::size_t>() + 1);
  EXPECT_EQ(history.front(), json["residual"]["initial_rms"]);
  EXPECT_EQ(history.back(), json["residual"]["rms"]);
  for (std::size_t i = 1; i < history.size(); ++i) EXPECT_LT(history[i], history[i - 1]);
  for (const ordered_json& light : json["lights"]) {
    // 1.5 m in the session's mm.
    EXPECT_NEAR(light["intensity"], std::pow(1500.0 / light["distance"].get<double>(), 2), 1e-9);
    for (const char* key : {"direction_sigma_deg", "inverse_distance_sigma", "distance_sigma",
                            "distance_min", "position_covariance", "intensity_sigma"})
      EXPECT_TRUE(light[key].is_null()) << key;
  }
  std::vector<std::string> codes;
  for (const ordered_json& note : json["notes"]) codes.push_back(note["code"]);
  EXPECT_THAT(codes, Contains("distance-brightness-equivalent"));
  EXPECT_THAT(codes, Contains("sigma-none"));
  EXPECT_THAT(codes, Not(Contains("null-sigma")));
  EXPECT_EQ(RunProgram({"render", folder_ / "s", "--params", folder_ / "r/result.json", "--out",
                        folder_ / "relit"})
                .exit_code,
            0);
}

TEST_F(Estimate, RefusesWhatIsNotOfTheMethod) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"--method", "best"}, "--method"},
      {{"--ceiling-distance", "2"}, "--ceiling-distance: with --method paper only"},
      {{"--method", "paper", "--ceiling-distance", "0"}, "--ceiling-distance"},
      {{"--method", "paper", "--ceiling-distance", "-2"}, "--ceiling-distance"},
      {{"--method", "paper", "--ceiling-distance", "high"}, "--ceiling-distance"},
      {{"--method", "paper", "--initial", folder_ / "s/truth.json"}, "--initial: not with"}};
  for (const auto& [words, message] : cases) {
    const Outcome outcome = RunEstimate("r", words);
    EXPECT_EQ(outcome.exit_code, 2) << words.back();
    EXPECT_THAT(outcome.err, HasSubstr(message));
  }
  std::string session = ReadText(folder_ / "s/session.json");
  session.replace(session.find("\"mm\""), 4, "\"ell\"");
  WriteText(folder_ / "s/session.json", session);
  const Outcome outcome = RunEstimate("r", {"--method", "paper"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("length_unit \"ell\""));
}

TEST_F(Estimate, NeverTouchesTheSession) {
  for (const std::string out : {"s", "s/result"}) {
    const Outcome outcome = RunEstimate(out);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("never changes"));
  }
}

}  // namespace
}  // namespace turnlight::app
