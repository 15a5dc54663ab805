// Proves of whole runs of the program on a small simulated rig: the same bytes twice, with 1, 2 and
// 4 threads, on either executor, after faults and from a replay; a result that equals `estimate`'s;
// refusals. Does not test accuracy, nor real devices.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "base/file.h"
#include "program.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;

// The main config, smaller.
class Run : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::path(testing::TempDir()) /
            (std::string("run_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(root_);
    fs::create_directories(root_);
    config_ = Config("small.yaml", "simulated_turntable.yaml");
  }
  void TearDown() override { fs::remove_all(root_); }

  std::string Config(const std::string& name, const std::string& from,
                     const std::string& replaced = "", const std::string& by = "") {
    std::string text = *ReadFile(fs::path(TURNLIGHT_SOURCE_DIR) / "configs" / from);
    Replace(text, "count: 36", "count: 6");
    Replace(text, "step_deg: 10", "step_deg: 60");
    Replace(text, "size: [320, 240], focal_px: 640", "size: [80, 60], focal_px: 160");
    if (!replaced.empty()) Replace(text, replaced, by);
    const fs::path path = root_ / name;
    std::ofstream(path) << text;
    return path.string();
  }
  static void Replace(std::string& text, const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    ASSERT_NE(at, std::string::npos) << what;
    text.replace(at, what.size(), by);
  }
  std::string Out(const std::string& name) const { return (root_ / name).string(); }

  // What sha256 says of the session; empty if it is not good.
  static std::string Session(const std::string& out) {
    const Outcome verified = RunProgram({"verify", out + "/session"});
    EXPECT_EQ(verified.exit_code, 0) << verified.out;
    const std::size_t at = verified.out.find("content sha256");
    return at == std::string::npos ? "" : verified.out.substr(at);
  }
  static std::string ResultWithoutTimes(const std::string& out) {
    auto json = nlohmann::json::parse(*ReadFile(out + "/result.json"));
    json.erase("time_s");
    return json.dump();
  }
  void ExpectRuns(const std::vector<std::string>& arguments) {
    const Outcome outcome = RunProgram(arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }

  fs::path root_;
  std::string config_;
};

TEST_F(Run, IsTheSameForAnyNumberOfThreads) {
  for (const std::string threads : {"1", "2", "4"})
    ExpectRuns({"run", config_, "--out", Out(threads), "--threads", threads});
  ExpectRuns({"run", config_, "--out", Out("again")});
  for (const std::string other : {"2", "4", "again"}) {
    EXPECT_EQ(Session(Out("1")), Session(Out(other)));
    EXPECT_TRUE(*ReadFile(Out("1") + "/log") == *ReadFile(Out(other) + "/log")) << other;
    EXPECT_EQ(ResultWithoutTimes(Out("1") + "/result"), ResultWithoutTimes(Out(other) + "/result"));
  }
}

TEST_F(Run, ResultIsThatOfEstimateAndOfAReplay) {
  ExpectRuns({"run", config_, "--out", Out("run")});
  ExpectRuns({"estimate", Out("run") + "/session", "--out", Out("estimate")});
  EXPECT_EQ(ResultWithoutTimes(Out("run") + "/result"), ResultWithoutTimes(Out("estimate")));
  ExpectRuns({"replay", Out("run") + "/log", "--out", Out("replay")});
  EXPECT_EQ(Session(Out("run")), Session(Out("replay")));
  EXPECT_EQ(ResultWithoutTimes(Out("run") + "/result"),
            ResultWithoutTimes(Out("replay") + "/result"));
  EXPECT_TRUE(*ReadFile(Out("run") + "/log") == *ReadFile(Out("replay") + "/log"));
}

TEST_F(Run, ThreadsAndRealTimeGiveTheSameSessionAndResult) {
  ExpectRuns({"run", config_, "--out", Out("virtual")});
  const std::string wall =
      Config("wall.yaml", "simulated_turntable.yaml", "executor: virtual", "executor: wall");
  ExpectRuns({"run", wall, "--out", Out("wall")});
  EXPECT_EQ(Session(Out("virtual")), Session(Out("wall")));
  EXPECT_EQ(ResultWithoutTimes(Out("virtual") + "/result"),
            ResultWithoutTimes(Out("wall") + "/result"));
}

TEST_F(Run, SecondRunIntoTheSameFolderIsRefused) {
  ExpectRuns({"capture", config_, "--out", Out("run")});
  const std::string before = Session(Out("run"));
  const Outcome second = RunProgram({"run", config_, "--out", Out("run")});
  EXPECT_EQ(second.exit_code, 2) << second.err;
  EXPECT_EQ(Session(Out("run")), before);
}

TEST_F(Run, PausesWithEveryGoodFrameKept) {
  const std::string faulty =
      Config("faulty.yaml", "simulated_turntable.yaml", "  camera:\n",
             "  faults: {list: [{at: {keyframe: 3}, fault: all_black, times: 4}]}\n  camera:\n");
  const Outcome paused = RunProgram({"capture", faulty, "--out", Out("paused")});
  EXPECT_EQ(paused.exit_code, 3) << paused.err;
  EXPECT_NE(paused.err.find("3 frames are missing"), std::string::npos) << paused.err;
}

TEST_F(Run, PlanAndGraphChangeNothing) {
  const Outcome plan = RunProgram({"plan", config_});
  EXPECT_EQ(plan.exit_code, 0) << plan.err;
  EXPECT_NE(plan.out.find("0 60 120 180 240 300"), std::string::npos) << plan.out;
  const Outcome graph = RunProgram({"graph", config_});
  EXPECT_EQ(graph.exit_code, 0) << graph.err;
  EXPECT_NE(graph.out.find("keyframes"), std::string::npos);
  const Outcome dot = RunProgram({"graph", config_, "--dot"});
  EXPECT_EQ(dot.out.rfind("digraph", 0), 0u) << dot.out;
}

TEST_F(Run, UnknownDriverIsRefusedWithWhatIsAllowed) {
  const std::string other =
      Config("other.yaml", "simulated_turntable.yaml", "driver: mock", "driver: magic");
  const Outcome outcome = RunProgram({"plan", other});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("magic"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("mock"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace turnlight::app
