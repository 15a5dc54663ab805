// Proves of whole runs with a simulated camera that is carried by hand (configs/handheld.yaml): the
// lights are found within what the result states, a replay gives the same, a resume takes what is
// missing from views that are not there yet; the session says nothing of angles; what cannot be is
// refused. Does not prove anything of real cameras and people.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "base/angles.h"
#include "calib/calibrate/handheld/view_change.h"
#include "rig/session/session.h"
#include "tests/app/program.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class RunByHand : public testing::Test {
 protected:
  std::string Config(const std::string& what = "", const std::string& by = "") {
    std::string text = ReadText(fs::path(TURNLIGHT_SOURCE_DIR) / "configs/handheld.yaml");
    Replace(text, "count: 24", "count: 6");
    if (!what.empty()) Replace(text, what, by);
    WriteText(root_ / "by_hand.yaml", text);
    return (root_ / "by_hand.yaml").string();
  }
  std::string Out(const std::string& name) const { return (root_ / name).string(); }
  // Smallest angle between the views of two frames.
  static double NearestDeg(const rig::Session& session) {
    double nearest = 180.0;
    calib::calibrate::handheld::ViewChange kept(10.0);
    for (const rig::FrameRecord& frame : session.frames) {
      const auto direction =
          calib::calibrate::handheld::ViewDirection(frame.X_WT.Inverse() * frame.X_WC);
      nearest = std::min(nearest, kept.NearestDeg(direction).value_or(180.0));
      kept.Add(direction);
    }
    return nearest;
  }
  static rig::Session Read(const std::string& folder) {
    auto session = rig::ReadSession(folder);
    if (!session) throw std::runtime_error(session.error().text);
    return std::move(*session);
  }

  const TemporaryFolder folder_;
  const fs::path root_ = folder_.path();
};

TEST_F(RunByHand, TheExampleFindsItsLightsAndAReplayGivesTheSame) {
  const Outcome run = RunProgram({"run", Config(), "--out", Out("run")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, AllOf(HasSubstr("6 frames, 10\u00b0 of view change apart"),
                             HasSubstr("frame 6/6\n"), HasSubstr("1 of 6: move on ")));
  const rig::Session session = Read(Out("run/session"));
  ASSERT_EQ(session.frames.size(), 6u);
  EXPECT_FALSE(session.frames[0].angle_deg);
  EXPECT_GE(NearestDeg(session), 10.0);
  const auto truth = nlohmann::json::parse(ReadText(Out("run/session/truth.json")));
  const auto result = nlohmann::json::parse(ReadText(Out("run/result/result.json")));
  ASSERT_EQ(result["lights"].size(), 2u) << result["lights"].dump();
  for (std::size_t i = 0; i < 2; ++i) {
    double dot = 0.0;
    for (int k = 0; k < 3; ++k)
      dot += result["lights"][i]["direction"][k].get<double>() *
             truth["lights"][i]["direction"][k].get<double>();
    EXPECT_LT(RadToDeg(std::acos(std::min(1.0, dot))), 0.5) << i;
  }
  ASSERT_EQ(RunProgram({"replay", Out("run/log"), "--out", Out("again")}).exit_code, 0);
  EXPECT_EQ(ContentOf(Out("run/session")), ContentOf(Out("again/session")));
  EXPECT_EQ(ResultWithoutTimes(Out("run/result")), ResultWithoutTimes(Out("again/result")));
}

TEST_F(RunByHand, AResumeTakesWhatIsMissingFromANewView) {
  ASSERT_EQ(RunProgram({"capture", Config(), "--out", Out("run")}).exit_code, 0);
  fs::remove(Out("run/session/session.json"));
  fs::remove(Out("run/session/frames/002.png"));
  const Outcome resumed = RunProgram({"resume", Out("run")});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(resumed.err, AllOf(HasSubstr("frame 2: "), HasSubstr("5 of 6 frames are safe")));
  const rig::Session session = Read(Out("run/session"));
  ASSERT_EQ(session.frames.size(), 6u);
  EXPECT_GE(NearestDeg(session), 10.0);
  EXPECT_EQ(RunProgram({"verify", Out("run/session")}).exit_code, 0);
}

TEST_F(RunByHand, AsOftenAsItIsRunItIsTheSame) {
  for (const std::string threads : {"1", "2"})
    ASSERT_EQ(RunProgram({"capture", Config("count: 6", "count: 2"), "--out", Out(threads),
                          "--threads", threads})
                  .exit_code,
              0);
  EXPECT_EQ(ContentOf(Out("1/session")), ContentOf(Out("2/session")));
}

TEST_F(RunByHand, PlanSaysWhatItCan) {
  const Outcome plan = RunProgram({"plan", Config()});
  EXPECT_EQ(plan.exit_code, 0) << plan.err;
  EXPECT_THAT(plan.out, AllOf(HasSubstr("views     10\u00b0 apart at least"),
                              HasSubstr("6, 6 exposures"), testing::Not(HasSubstr("travel"))));
}

TEST_F(RunByHand, WhatCannotBeIsRefused) {
  const auto refused = [&](const std::string& what, const std::string& by, const std::string& why) {
    const Outcome run = RunProgram({"run", Config(what, by), "--out", Out("refused")});
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_THAT(run.err, HasSubstr(why));
    EXPECT_FALSE(fs::exists(Out("refused")));
  };
  refused("  camera: {driver: mock}", "  table: {driver: mock}\n  camera: {driver: mock}", "table");
  refused("exposures_us: [8000]", "exposures_us: [8000, 2000]",
          "2 exposures, allowed is one of a camera that is carried by hand");
  refused("exposures_us: [8000]", "settle_ms: 200", "settle_ms");
  refused("  walk:\n", "  geometry: {}\n  prop:\n    kind: handheld\n", "");
  refused("camera: {type: camera, params: {poll_ms: 5}}",
          "camera: {type: camera}\n    table: {type: turntable}",
          "1 nodes of type turntable, allowed is exactly 0 with handheld_keyframes");
  refused("columns: 8, rows: 6, spacing: 16, marker: 12, dictionary: 4X4_50}\n        at",
          "columns: 8, rows: 6, spacing: 16, marker: 17, dictionary: 4X4_50}\n        at",
          "marker");
  refused("  target: {shape: sphere, radius: 25}\n  length_unit: mm",
          "  target: {shape: sphere, radius: 25}\n  lens: none.cameramodel", "none.cameramodel");
}

}  // namespace
}  // namespace turnlight::app
