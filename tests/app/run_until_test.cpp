// Proves, of whole captures on a small simulated rig that go on until the lights are known: they
// stop early, add keyframes or give up, and say why in session.json; the same bytes twice, for
// other numbers of threads, on either executor, from a replay, and after an interruption at any
// keyframe; `capture` decides alike; refusals. Does not prove that sigmas are right, nor which
// keyframes help (tests/estimator/next_view_test.cpp).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "tests/app/program.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class RunUntil : public testing::Test {
 protected:
  // 12 keyframes in steps of 30 degrees, 80 x 60 pixels; an estimate after each.
  std::string Config(const std::string& name, const std::string& direction_deg,
                     const std::string& most_extra = "2") {
    std::string text =
        ReadText(fs::path(TURNLIGHT_SOURCE_DIR) / "configs" / "simulated_until.yaml");
    Replace(text, "count: 36", "count: 12");
    Replace(text, "step_deg: 10", "step_deg: 30");
    Replace(text, "size: [320, 240], focal_px: 640", "size: [80, 60], focal_px: 160");
    Replace(text, "every: 3", "every: 1");
    Replace(text, "direction_deg: 0.02", "direction_deg: " + direction_deg);
    Replace(text, "most_extra: 6", "most_extra: " + most_extra);
    WriteText(root_ / name, text);
    return (root_ / name).string();
  }
  std::string Out(const std::string& name) const { return (root_ / name).string(); }
  void ExpectRuns(const std::vector<std::string>& arguments) {
    const Outcome outcome = RunProgram(arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  static nlohmann::json SessionOf(const std::string& out) {
    return nlohmann::json::parse(ReadText(out + "/session/session.json"));
  }
  // Leaves of a finished capture what there was after so many keyframes.
  static void CutAfter(const std::string& out, std::size_t keyframes) {
    std::istringstream journal(ReadText(out + "/session/journal.jsonl"));
    std::string text, line;
    for (std::size_t i = 0; i <= keyframes && std::getline(journal, line); ++i) text += line + "\n";
    WriteText(out + "/session/journal.jsonl", text);
    fs::remove(out + "/session/session.json");
    fs::remove_all(out + "/result");
  }
  void ExpectSame(const std::string& a, const std::string& b) {
    EXPECT_EQ(ContentOf(Out(a) + "/session"), ContentOf(Out(b) + "/session"));
    EXPECT_EQ(ResultWithoutTimes(Out(a) + "/result"), ResultWithoutTimes(Out(b) + "/result"));
  }

  const TemporaryFolder folder_;
  const fs::path root_ = folder_.path();
};

TEST_F(RunUntil, StopsEarlyAndTheSameTwice) {
  const std::string config = Config("early.yaml", "0.5");
  ExpectRuns({"run", config, "--out", Out("one"), "--threads", "1"});
  const nlohmann::json session = SessionOf(Out("one"));
  EXPECT_EQ(session["x-ended"]["code"], "early");
  EXPECT_GE(session["frames"].size(), 4u) << "a quarter turn of 30 degrees";
  EXPECT_LT(session["frames"].size(), 12u);
  EXPECT_THAT(session["x-ended"]["words"].get<std::string>(), HasSubstr("of 12 keyframes"));
  ExpectRuns({"run", config, "--out", Out("two"), "--threads", "2"});
  ExpectSame("one", "two");
  EXPECT_TRUE(ReadText(Out("one") + "/log") == ReadText(Out("two") + "/log"));
}

TEST_F(RunUntil, AddsKeyframesWhereTheyHelp) {
  ExpectRuns({"run", Config("all.yaml", "1e-5", "0"), "--out", Out("all")});
  const double sigma = nlohmann::json::parse(
      ReadText(Out("all") + "/result/result.json"))["lights"][1]["direction_sigma_deg"];
  const std::string config = Config("more.yaml", std::to_string(0.99 * sigma), "12");
  const Outcome outcome = RunProgram({"run", config, "--out", Out("one")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json session = SessionOf(Out("one"));
  ASSERT_GT(session["frames"].size(), 12u) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("One more keyframe, at "));
  const double added = session["frames"][12]["angle_deg"];
  EXPECT_NE(std::fmod(added, 30.0), 0.0);
  EXPECT_EQ(session["frames"][12]["image"], "frames/012.png");
  ExpectRuns({"run", config, "--out", Out("two")});
  ExpectSame("one", "two");
  ExpectRuns({"replay", Out("one") + "/log", "--out", Out("replay")});
  ExpectSame("one", "replay");
  for (const std::size_t keyframes : {std::size_t{5}, std::size_t{12}, std::size_t{13}}) {
    CutAfter(Out("two"), keyframes);
    ExpectRuns({"resume", Out("two")});
    ExpectSame("one", "two");
  }
}

TEST_F(RunUntil, GivesUpAndSaysWhy) {
  const Outcome most = RunProgram({"run", Config("most.yaml", "1e-5", "1"), "--out", Out("most")});
  ASSERT_EQ(most.exit_code, 0) << most.err;
  const nlohmann::json ended = SessionOf(Out("most"))["x-ended"];
  EXPECT_THAT(ended["code"].get<std::string>(), testing::AnyOf("most-extra", "floor"));
  EXPECT_THAT(most.err, HasSubstr(ended["words"].get<std::string>()));
  const Outcome again = RunProgram({"resume", Out("most")});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("complete already"));
  EXPECT_EQ(SessionOf(Out("most"))["x-ended"], ended);
}

TEST_F(RunUntil, CaptureAloneAndRealTimeDecideAlike) {
  std::string text = ReadText(Config("virtual.yaml", "0.5"));
  RunQuickly(text);
  WriteText(root_ / "wall.yaml", text);
  Replace(text, "executor: wall", "executor: virtual");
  WriteText(root_ / "virtual.yaml", text);
  ExpectRuns({"run", Out("virtual.yaml"), "--out", Out("virtual")});
  ExpectRuns({"run", Out("wall.yaml"), "--out", Out("wall")});
  ExpectRuns({"capture", Out("virtual.yaml"), "--out", Out("alone")});
  ASSERT_EQ(SessionOf(Out("virtual"))["x-ended"]["code"], "early");
  ExpectSame("virtual", "wall");
  EXPECT_EQ(ContentOf(Out("virtual") + "/session"), ContentOf(Out("alone") + "/session"));
}

TEST_F(RunUntil, RefusesWhatCannotDecide) {
  const auto refusal = [&](const std::string& what, const std::string& by) {
    std::string text = ReadText(Config("bad.yaml", "0.5"));
    Replace(text, what, by);
    WriteText(root_ / "bad.yaml", text);
    const Outcome outcome = RunProgram({"run", Out("bad.yaml"), "--out", Out("bad")});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_FALSE(fs::exists(Out("bad")));
    return outcome.err;
  };
  EXPECT_THAT(
      refusal("direction_deg: 0.5", "direction_deg: 0"),
      testing::AllOf(HasSubstr("bad.yaml"), HasSubstr("direction_deg"), HasSubstr("above 0")));
  EXPECT_THAT(refusal("most_extra: 2", "most_extra: -1"), HasSubstr("most_extra"));
  EXPECT_THAT(
      refusal("    - {from: estimator.verdict, to: keyframes.verdict, policy: {keep_last: 1}}\n",
              ""),
      HasSubstr("capture/until needs {from: estimator.verdict, to: keyframes.verdict"));
  EXPECT_THAT(refusal("  until:\n", "  closure: true\n  until:\n"), HasSubstr("beside closure"));
}

}  // namespace
}  // namespace turnlight::app
