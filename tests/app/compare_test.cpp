// Proves: what `turnlight compare` takes (results, sessions, runs), prints and writes, all its exit
// codes, and the words of its refusals. How quantities are judged: tests/base/comparison_test.cpp,
// tests/estimator/results and tests/rig/session.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "estimator/results/result_json.h"
#include "tests/app/program.h"
#include "tests/estimator/results/example_estimate.h"

namespace turnlight::app {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

estimator::Estimate AnEstimate() {
  estimator::Estimate estimate = estimator::results::ExampleEstimate();
  for (estimator::LightEstimate& light : estimate.lights) {
    light.direction_sigma = 1e-3;
    light.diffuse_product_sigma = Eigen::Vector3d::Constant(0.001);
  }
  return estimate;
}

void WriteResult(const estimator::Estimate& estimate, const std::filesystem::path& file) {
  std::filesystem::create_directories(file.parent_path());
  WriteText(file, estimator::results::ResultToJson(estimate, "s",
                                                   estimator::results::Method::kLeastSquares, {}));
}

// a: an estimate; b: the same, its near light 20 sigmas further away.
void WriteTwoResults(const TemporaryFolder& folder) {
  estimator::Estimate estimate = AnEstimate();
  WriteResult(estimate, folder.path() / "a/result.json");
  estimate.lights[0].distance = 700.0 + 20.0 * 1.24 * std::sqrt(2.0);
  WriteResult(estimate, folder.path() / "b/result.json");
}

TEST(Compare, ResultsThatAreTheSame) {
  const TemporaryFolder folder;
  WriteTwoResults(folder);
  const Outcome outcome = RunProgram({"compare", folder / "a", folder / "a/result.json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("results: the same"));
  EXPECT_EQ(Count(outcome.out, "\n"), 1U);
  EXPECT_EQ(outcome.err, "");
}

TEST(Compare, ResultsThatAreDifferent) {
  const TemporaryFolder folder;
  WriteTwoResults(folder);
  const Outcome outcome = RunProgram({"compare", folder / "a", folder / "b"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.out, HasSubstr("results: different, 1 of "));
  EXPECT_THAT(outcome.out,
              HasSubstr("  light 1: distance  700  735.072  35.1        20      3 sigmas"));
}

TEST(Compare, ATolerance) {
  const TemporaryFolder folder;
  WriteTwoResults(folder);
  WriteText(folder / "t.yaml", "result: {distance: {relative: 0.1}}\n");
  EXPECT_EQ(RunProgram({"compare", folder / "a", folder / "b", "--tolerance", folder / "t.yaml"})
                .exit_code,
            0);
  WriteText(folder / "t.yaml", "result: {distance: {relative: 0.1, require: both}}\n");
  EXPECT_EQ(RunProgram({"compare", folder / "a", folder / "b", "--tolerance", folder / "t.yaml"})
                .exit_code,
            3);
}

TEST(Compare, TheExampleToleranceFileIsGood) {
  const TemporaryFolder folder;
  WriteTwoResults(folder);
  const std::string example = std::string(TURNLIGHT_SOURCE_DIR) + "/configs/compare_tolerance.yaml";
  const Outcome outcome =
      RunProgram({"compare", folder / "a", folder / "a", "--tolerance", example});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST(Compare, Json) {
  const TemporaryFolder folder;
  WriteTwoResults(folder);
  const Outcome outcome = RunProgram({"compare", folder / "a", folder / "b", "--json"});
  EXPECT_EQ(outcome.exit_code, 3);
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["format"], "turnlight-comparison");
  EXPECT_EQ(json["same"], false);
  EXPECT_EQ(json["comparisons"][0]["what"], "results");
  int different = 0;
  for (const auto& quantity : json["comparisons"][0]["quantities"]) {
    if (quantity["verdict"] != "different") continue;
    ++different;
    EXPECT_EQ(quantity["name"], "distance");
    EXPECT_EQ(quantity["a"], 700.0);
    EXPECT_NEAR(quantity["sigmas"].get<double>(), 20.0, 1e-9);
    EXPECT_EQ(quantity["sigmas_limit"], 3.0);
  }
  EXPECT_EQ(different, 1);
}

TEST(Compare, JunitIsReadByAnXmlReader) {
  const TemporaryFolder folder;
  WriteTwoResults(folder);
  const Outcome outcome =
      RunProgram({"compare", folder / "a", folder / "b", "--junit", folder / "j.xml"});
  EXPECT_EQ(outcome.exit_code, 3);
  WriteText(folder / "read.py",
            "import sys, xml.etree.ElementTree as tree\n"
            "suite = tree.parse(sys.argv[1]).getroot().find('testsuite')\n"
            "cases = suite.findall('testcase')\n"
            "assert int(suite.get('tests')) == len(cases) > 20\n"
            "failed = [case for case in cases if case.find('failure') is not None]\n"
            "assert len(failed) == int(suite.get('failures')) == 1\n"
            "assert failed[0].get('classname') == 'results.light 1', failed[0].get('classname')\n"
            "assert failed[0].get('name') == 'distance'\n"
            "assert '20 sigmas, allowed is 3 sigmas' in failed[0].find('failure').text\n");
  const std::string command = "python3 '" + (folder / "read.py") + "' '" + (folder / "j.xml") + "'";
  EXPECT_EQ(std::system(command.c_str()), 0) << ReadText(folder / "j.xml");
}

TEST(Compare, Sessions) {
  const TemporaryFolder folder;
  rig::sim::SyntheticConfig config = SmallConfig();
  config.sensor.noise_relative = 0.005;
  WriteSession(config, folder / "a");
  WriteSession(config, folder / "b");
  const Outcome identical = RunProgram({"compare", folder / "a", folder / "b"});
  EXPECT_EQ(identical.exit_code, 0) << identical.err;
  EXPECT_THAT(identical.out, StartsWith("sessions: identical, content sha256 "));
  config.seed += 1;
  WriteSession(config, folder / "c");
  const Outcome other_noise =
      RunProgram({"compare", folder / "a", folder / "c", "--junit", folder / "j.xml"});
  EXPECT_EQ(other_noise.exit_code, 0) << other_noise.out;
  EXPECT_THAT(other_noise.out, HasSubstr("sessions: the same"));
  EXPECT_THAT(ReadText(folder / "j.xml"),
              AllOf(HasSubstr("sessions.frame 1"), HasSubstr("failures=\"0\"")));
  config.motion.step_deg += 0.5;
  WriteSession(config, folder / "d");
  const Outcome different = RunProgram({"compare", folder / "a", folder / "d"});
  EXPECT_EQ(different.exit_code, 3);
  EXPECT_THAT(different.out, HasSubstr("frame 1"));
}

TEST(Compare, RunsAreTheirSessionsAndTheirResults) {
  const TemporaryFolder folder;
  for (const std::string run : {"a", "b"}) {
    WriteSession(SmallConfig(), folder / (run + "/session"));
    WriteResult(AnEstimate(), folder / (run + "/result/result.json"));
  }
  const Outcome same = RunProgram({"compare", folder / "a", folder / "b"});
  EXPECT_EQ(same.exit_code, 0) << same.out << same.err;
  EXPECT_THAT(same.out, AllOf(HasSubstr("sessions: identical"), HasSubstr("results: the same")));
  estimator::Estimate other = AnEstimate();
  other.lights.pop_back();
  other.stat.lights.pop_back();
  WriteResult(other, folder / "b/result/result.json");
  const Outcome different = RunProgram({"compare", folder / "a", folder / "b"});
  EXPECT_EQ(different.exit_code, 3);
  EXPECT_THAT(different.out, HasSubstr("this light is in A only"));
  const Outcome kinds = RunProgram({"compare", folder / "a", folder / "b/session"});
  EXPECT_EQ(kinds.exit_code, 2);
  EXPECT_THAT(kinds.err, AllOf(HasSubstr("a is a run with a session and a result"),
                               HasSubstr("b/session is a session")));
}

TEST(Compare, Refusals) {
  const TemporaryFolder folder;
  WriteTwoResults(folder);
  WriteSession(SmallConfig(), folder / "s");
  std::filesystem::create_directory(folder / "empty");
  WriteText(folder / "bad.json", "{\"format\": \"turnlight-session\"}");
  WriteText(folder / "bad.yaml", "result: {distance: {relativ: 0.1}}\n");
  const std::vector<std::pair<std::vector<std::string>, std::string>> bad{
      {{folder / "a", folder / "s"}, "allowed are two of a kind"},
      {{folder / "a", folder / "none"}, "none: is not there, allowed is a result.json"},
      {{folder / "empty", folder / "a"}, "empty: neither a session nor a result"},
      {{folder / "a", folder / "bad.json"}, "bad.json: format"},
      {{folder / "s/session.json", folder / "s"}, "allowed is the session's folder"},
      {{folder / "a", folder / "b", "--tolerance", folder / "bad.yaml"},
       "did you mean \"relative\"?"},
      {{folder / "a", folder / "b", "--tolerance", folder / "none.yaml"}, "none.yaml"},
      {{folder / "a", folder / "b", "--junit", folder / "none/j.xml"}, "none/j.xml"},
      {{folder / "a"}, "B is required"}};
  for (const auto& [arguments, message] : bad) {
    std::vector<std::string> line{"compare"};
    line.insert(line.end(), arguments.begin(), arguments.end());
    const Outcome outcome = RunProgram(line);
    EXPECT_EQ(outcome.exit_code, 2) << message;
    EXPECT_THAT(outcome.err, HasSubstr(message));
    EXPECT_EQ(outcome.out, "");
  }
}

TEST(Compare, AnUnfinishedCaptureSaysSo) {
  const TemporaryFolder folder;
  WriteSession(SmallConfig(), folder / "a");
  std::filesystem::create_directory(folder / "b");
  WriteText(folder / "b/journal.jsonl", "");
  EXPECT_EQ(RunProgram({"compare", folder / "a", folder / "b"}).exit_code, 2);
}

}  // namespace
}  // namespace turnlight::app
