// Proves of whole runs of the program on a small simulated rig: the same bytes twice, with 1, 2 and
// 4 threads, on either executor, after faults and from a replay; a result that equals `estimate`'s;
// refusals. Does not test accuracy, nor real devices.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <tuple>

#include "calib/radiometry.h"
#include "rig/session/session.h"
#include "tests/app/program.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;

// The main config, smaller.
class Run : public testing::Test {
 protected:
  void SetUp() override { config_ = Config("small.yaml", "simulated_turntable.yaml"); }

  std::string Config(const std::string& name, const std::string& from,
                     const std::string& replaced = "", const std::string& by = "") {
    std::string text = ReadText(fs::path(TURNLIGHT_SOURCE_DIR) / "configs" / from);
    Replace(text, "count: 36", "count: 6");
    Replace(text, "step_deg: 10", "step_deg: 60");
    Replace(text, "size: [320, 240], focal_px: 640", "size: [80, 60], focal_px: 160");
    if (!replaced.empty()) Replace(text, replaced, by);
    const fs::path path = root_ / name;
    WriteText(path, text);
    return path.string();
  }
  std::string Out(const std::string& name) const { return (root_ / name).string(); }

  static std::string Session(const std::string& out) { return ContentOf(out + "/session"); }
  void ExpectRuns(const std::vector<std::string>& arguments) {
    const Outcome outcome = RunProgram(arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }

  const TemporaryFolder folder_;
  const fs::path root_ = folder_.path();
  std::string config_;
};

TEST_F(Run, IsTheSameForAnyNumberOfThreads) {
  for (const std::string threads : {"1", "2", "4"})
    ExpectRuns({"run", config_, "--out", Out(threads), "--threads", threads});
  ExpectRuns({"run", config_, "--out", Out("again")});
  for (const std::string other : {"2", "4", "again"}) {
    EXPECT_EQ(Session(Out("1")), Session(Out(other)));
    EXPECT_TRUE(ReadText(Out("1") + "/log") == ReadText(Out(other) + "/log")) << other;
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
  EXPECT_TRUE(ReadText(Out("run") + "/log") == ReadText(Out("replay") + "/log"));
}

TEST_F(Run, ThreadsAndRealTimeGiveTheSameSessionAndResult) {
  std::string text = ReadText(config_);
  RunQuickly(text);
  const std::string wall = Out("wall.yaml"), virtually = Out("virtual.yaml");
  WriteText(wall, text);
  Replace(text, "executor: wall", "executor: virtual");
  WriteText(virtually, text);
  ExpectRuns({"run", virtually, "--out", Out("virtual")});
  ExpectRuns({"run", wall, "--out", Out("wall")});
  EXPECT_EQ(Session(Out("virtual")), Session(Out("wall")));
  EXPECT_EQ(ResultWithoutTimes(Out("virtual") + "/result"),
            ResultWithoutTimes(Out("wall") + "/result"));
}

// A bracket whose first exposure is not the reference, against the shorter exposure alone: the same
// radiance, saturated where that is.
TEST_F(Run, ABracketIsSaturatedWhereItsShortestExposureIs) {
  const auto capture = [this](const std::string& name, const std::string& exposures_us) {
    std::string text = ReadText(config_);
    Replace(text, "count: 6", "count: 1");
    Replace(text, "exposures_us: [8000]", "exposures_us: " + exposures_us);
    Replace(text, "reference_exposure_us: 8000", "reference_exposure_us: 4000");
    Replace(text, "intensity: 0.8", "intensity: 5");
    WriteText(root_ / (name + ".yaml"), text);
    const Outcome outcome =
        RunProgram({"capture", (root_ / (name + ".yaml")).string(), "--out", Out(name)});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto session = rig::ReadSession(Out(name) + "/session");
    if (!session) throw std::runtime_error(session.error().text);
    const auto images = rig::ReadFrameImages(*session, 0);
    if (!images) throw std::runtime_error(images.error().text);
    return calib::Linearise(images->image, session->radiometry, session->frames[0].exposure);
  };
  const calib::LinearImage alone = capture("alone", "[2000]");
  const calib::LinearImage bracket = capture("bracket", "[16000, 2000]");
  const int saturated = cv::countNonZero(alone.saturated);
  EXPECT_GT(saturated, 20);
  EXPECT_LE(cv::countNonZero(alone.saturated != bracket.saturated), saturated / 20);  // noise
  const std::string lines = ReadText(Out("bracket") + "/session/provenance.jsonl");
  const auto of_frame = nlohmann::json::parse(lines.substr(lines.find('\n')));
  ASSERT_EQ(of_frame["counters"].size(), 2u);  // of each exposure
  EXPECT_LT(of_frame["counters"][0]["frame_id"], of_frame["counters"][1]["frame_id"]);
  const cv::Mat1b good = (alone.saturated == 0) & (bracket.saturated == 0);
  // Noise is cut off at black, more of it in the short exposure alone.
  EXPECT_NEAR(cv::mean(bracket.radiance, good)[0] / cv::mean(alone.radiance, good)[0], 1.0, 0.03);
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
      Config("faulty.yaml", "simulated_turntable.yaml", "  shutter: ",
             "  faults: {list: [{at: {keyframe: 3}, fault: all_black, times: 4}]}\n  shutter: ");
  const Outcome paused = RunProgram({"capture", faulty, "--out", Out("paused")});
  EXPECT_EQ(paused.exit_code, 3) << paused.err;
  EXPECT_NE(paused.err.find("3 frames are missing"), std::string::npos) << paused.err;
  EXPECT_EQ(Count(paused.err, "attempt 4 of 4"), 1u) << paused.err;  // what ended it, said once
}

TEST_F(Run, ADeviceThatDoesNotOpenIsToldBeforeAnythingIsWritten) {
  for (const std::string device : {"camera", "table"}) {
    const std::string config =
        Config("unplugged.yaml", "simulated_turntable.yaml", "  shutter: ",
               "  faults: {list: [{at: {time_s: 0}, fault: unplugged, device: " + device +
                   ", ms: 1000}]}\n  shutter: ");
    const Outcome outcome = RunProgram({"capture", config, "--out", Out("unplugged")});
    EXPECT_EQ(outcome.exit_code, 4) << outcome.err;
    EXPECT_NE(outcome.err.find(device == "camera" ? "MOCK-CAMERA-1" : "MOCK-TABLE-1"),
              std::string::npos)
        << outcome.err;
    EXPECT_NE(outcome.err.find("unplugged; check its cable and power, then give the same command "
                               "again: nothing was written"),
              std::string::npos)
        << outcome.err;
    EXPECT_FALSE(fs::exists(Out("unplugged")));
  }
}

TEST_F(Run, FaultsLeaveNoTraceInTheSession) {
  const auto capture = [this](const std::string& name) {
    std::string text =
        ReadText(fs::path(TURNLIGHT_SOURCE_DIR) / "configs" / ("simulated_" + name + ".yaml"));
    Replace(text, "name: simulated_" + name, "name: same");
    Replace(text, "count: 36", "count: 24");  // the last fault is at keyframe 21
    Replace(text, "size: [320, 240], focal_px: 640", "size: [80, 60], focal_px: 160");
    WriteText(root_ / (name + ".yaml"), text);
    const Outcome outcome =
        RunProgram({"capture", (root_ / (name + ".yaml")).string(), "--out", Out(name)});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.err;
  };
  EXPECT_EQ(capture("turntable").find("retry"), std::string::npos);
  const std::string faults = capture("faults");
  for (const std::string frame : {"3", "5", "9", "11", "13", "15", "17", "19", "21"})
    EXPECT_NE(faults.find("retry: frame " + frame + " ("), std::string::npos) << frame;
  EXPECT_EQ(Session(Out("faults")), Session(Out("turntable")));
}

TEST_F(Run, AnOpenLoopTableThatLostStepsIsSeenByTheClosure) {
  const auto with = [this](const std::string& name, const std::string& deg) {
    std::string text = ReadText(config_);
    Replace(text, "closure: false", "closure: true");
    Replace(text, "acceleration_deg_s2: 120}", "acceleration_deg_s2: 120, feedback: open_loop}");
    Replace(text, "  shutter: ",
            "  faults: {list: [{at: {keyframe: 3}, fault: lost_steps, deg: " + deg +
                "}]}\n  shutter: ");
    WriteText(root_ / (name + ".yaml"), text);
    return RunProgram({"run", (root_ / (name + ".yaml")).string(), "--out", Out(name)});
  };
  const auto notes = [this](const std::string& name) {
    return nlohmann::json::parse(ReadText(Out(name) + "/result/result.json"))["notes"].dump();
  };
  const Outcome kept = with("kept", "0");
  EXPECT_EQ(kept.exit_code, 0) << kept.err;
  EXPECT_NE(kept.err.find("the table kept its place"), std::string::npos) << kept.err;
  EXPECT_EQ(notes("kept").find("closure-open"), std::string::npos);
  const Outcome lost = with("lost", "2");
  EXPECT_EQ(lost.exit_code, 4) << lost.err;
  EXPECT_NE(lost.err.find("not to be trusted"), std::string::npos) << lost.err;
  EXPECT_EQ(Count(lost.err, "closure: "), 1u) << lost.err;
  EXPECT_NE(notes("lost").find("closure-open"), std::string::npos);
  const Outcome verified = RunProgram({"verify", Out("lost") + "/session"});
  EXPECT_EQ(verified.exit_code, 0);
  EXPECT_NE(verified.out.find("remark: closure: "), std::string::npos) << verified.out;
  const Outcome again = RunProgram({"resume", Out("lost")});  // complete already, and still lost
  EXPECT_EQ(again.exit_code, 4) << again.err;
  EXPECT_NE(again.err.find("not to be trusted"), std::string::npos) << again.err;
}

TEST_F(Run, ResumeOfAFinishedRunDoesWhatIsMissing) {
  ExpectRuns({"run", config_, "--out", Out("run")});
  const std::string result = ResultWithoutTimes(Out("run") + "/result");
  const Outcome again = RunProgram({"resume", Out("run")});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_NE(again.out.find("nothing is left to do"), std::string::npos) << again.out;
  fs::remove_all(Out("run") + "/result");
  ExpectRuns({"resume", Out("run")});
  EXPECT_EQ(ResultWithoutTimes(Out("run") + "/result"), result);
  const Outcome nothing = RunProgram({"resume", Out("nowhere")});
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_NE(nothing.err.find("no capture was begun here"), std::string::npos) << nothing.err;
  EXPECT_FALSE(fs::exists(Out("nowhere")));
}

// A session without a name has its config's; the copy in the folder is called otherwise.
TEST_F(Run, AConfigWithoutANameKeepsItOnResumeAndReplay) {
  const std::string config =
      Config("lump.yaml", "simulated_turntable.yaml", "name: simulated_turntable\n", "");
  ExpectRuns({"capture", config, "--out", Out("run")});
  const std::string whole = ReadText(Out("run") + "/session/session.json");
  EXPECT_NE(whole.find("\"name\": \"lump\""), std::string::npos) << whole;
  ExpectRuns({"replay", Out("run") + "/log", "--out", Out("again")});
  EXPECT_EQ(ReadText(Out("again") + "/session/session.json"), whole);
  fs::remove(Out("run") + "/session/session.json");
  ExpectRuns({"resume", Out("run")});
  EXPECT_EQ(ReadText(Out("run") + "/session/session.json"), whole);
}

TEST_F(Run, ReplayWithAnotherRigIsRefusedAndNamed) {
  ExpectRuns({"capture", config_, "--out", Out("run")});
  std::string text = ReadText(Out("run") + "/config.yaml");
  for (const auto& [part, was, is] : {std::tuple("simulation", "distance: 480", "distance: 490"),
                                      {"rig", "max_speed_deg_s: 30", "max_speed_deg_s: 31"}}) {
    std::string other = text;
    Replace(other, was, is);
    WriteText(Out("run") + "/config.yaml", other);
    const Outcome outcome = RunProgram({"replay", Out("run") + "/log", "--out", Out("again")});
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_NE(outcome.err.find(std::string("another \"") + part + "\""), std::string::npos)
        << outcome.err;
  }
}

TEST_F(Run, ReplayOfAFolderOrOfNoLogIsRefused) {
  ExpectRuns({"capture", config_, "--out", Out("run")});
  const Outcome whole = RunProgram({"replay", Out("run"), "--out", Out("again")});
  EXPECT_EQ(whole.exit_code, 2);
  EXPECT_NE(whole.err.find(Out("run") + ": a folder, allowed is the log of a run, " + Out("run") +
                           "/log for example"),
            std::string::npos)
      << whole.err;
  const Outcome none = RunProgram({"replay", Out("run") + "/lgo", "--out", Out("again")});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.err.find("run/lgo: cannot open"), std::string::npos) << none.err;
  EXPECT_FALSE(fs::exists(Out("again")));
}

TEST_F(Run, AGraphThatKeepsNoFrameIsRefused) {
  std::string text = ReadText(config_);
  Replace(text, "    recorder: {type: recorder, duration_ms: 20}\n", "");
  Replace(text,
          "    - {from: calibration.keyframe, to: recorder.keyframe, policy: block, capacity: 4}\n",
          "");
  const std::string config = (root_ / "none.yaml").string();
  WriteText(config, text);
  const Outcome outcome = RunProgram({"capture", config, "--out", Out("run")});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("graph/nodes: 0 nodes of type recorder, allowed is exactly 1"),
            std::string::npos)
      << outcome.err;
  EXPECT_FALSE(fs::exists(Out("run")));
}

TEST_F(Run, CaptureChecksTheEstimatorToo) {
  const std::string config = Config("topic.yaml", "simulated_turntable.yaml",
                                    "- estimator.estimate", "- estimator.estimates");
  const Outcome outcome = RunProgram({"capture", config, "--out", Out("run")});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("no output \"estimates\""), std::string::npos) << outcome.err;
}

// The main job as it ships.
TEST_F(Run, TheMainConfigFindsItsLights) {
  const std::string config =
      (fs::path(TURNLIGHT_SOURCE_DIR) / "configs/simulated_turntable.yaml").string();
  ExpectRuns({"run", config, "--out", Out("main")});
  const auto result = nlohmann::json::parse(ReadText(Out("main") + "/result/result.json"));
  const auto truth = nlohmann::json::parse(ReadText(Out("main") + "/session/truth.json"));
  EXPECT_EQ(result["views"], 36);
  ASSERT_EQ(result["lights"].size(), truth["lights"].size());
  const auto near = [](const nlohmann::json& found, double is) {
    EXPECT_NEAR(found.get<double>(), is, 0.03 * is);
  };
  const auto& is = truth["reflectance"];
  const double brightest = truth["lights"][0]["intensity"];
  for (std::size_t i = 0; i < result["lights"].size(); ++i) {
    const auto& found = result["lights"][i];
    const auto& light = truth["lights"][i];  // the strongest comes first in both
    double cosine = 0.0;
    for (int k = 0; k < 3; ++k)
      cosine += found["direction"][k].get<double>() * light["direction"][k].get<double>();
    EXPECT_LT(std::acos(std::min(cosine, 1.0)) * 180.0 / M_PI, 0.3) << i;
    const double intensity = light["intensity"];
    near(found["distance"], 1.0 / light["inverse_distance"].get<double>());
    near(found["intensity"], intensity / brightest);
    near(result["products"]["specular"][i], is["specular"].get<double>() * intensity);
    for (std::size_t c = 0; c < 3; ++c)
      near(result["products"]["diffuse"][i][c],
           is["albedo"][c].get<double>() * is["diffuse"].get<double>() * intensity);
  }
  for (std::size_t c = 0; c < 3; ++c)
    near(result["products"]["ambient"][c],
         is["albedo"][c].get<double>() * is["ambient"].get<double>());
  near(result["reflectance"]["shininess"], is["shininess"]);
}

TEST_F(Run, ProvenanceNamesProgramAndTime) {
  ExpectRuns({"capture", config_, "--out", Out("run")});
  const std::string lines = ReadText(Out("run") + "/session/provenance.jsonl");
  const auto run = nlohmann::json::parse(lines.substr(0, lines.find('\n')));
  EXPECT_FALSE(run["program_version"].get<std::string>().empty());
  EXPECT_FALSE(run["program_commit"].get<std::string>().empty());
  const std::string utc = run["utc"];
  EXPECT_EQ(utc.size(), std::string("2024-05-01T12:00:00.123Z").size()) << utc;
  EXPECT_EQ(utc.back(), 'Z') << utc;
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

TEST_F(Run, AMisspeltSectionIsNamed) {
  const Outcome outcome =
      RunProgram({"plan", Config("rigg.yaml", "simulated_turntable.yaml", "\nrig:", "\nrigg:")});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("rigg: unknown key"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("did you mean \"rig\"?"), std::string::npos) << outcome.err;
}

TEST_F(Run, ItsConfigIsCheckedAsOneAndNotShown) {
  EXPECT_EQ(RunProgram({"config", "check", config_}).exit_code, 0);
  const Outcome slip = RunProgram(
      {"config", "check", Config("slip.yaml", "simulated_turntable.yaml", "\ngraph:", "\ngrph:")});
  EXPECT_EQ(slip.exit_code, 2);
  EXPECT_NE(slip.err.find("did you mean \"graph\"?"), std::string::npos) << slip.err;
  const Outcome shown = RunProgram({"config", "show", config_});
  EXPECT_EQ(shown.exit_code, 2);
  EXPECT_NE(shown.err.find("a config for turnlight run, allowed is"), std::string::npos)
      << shown.err;
}

}  // namespace
}  // namespace turnlight::app
