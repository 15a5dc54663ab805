// Proves that `verify` tells a good session from one with bad frames and from one that is bad as a
// whole, by exit code and in words. Does not list all that can be wrong; bad_inputs_test and
// tests/rig/session do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/app/program.h"
#include "tests/rig/session/png_parts.h"

namespace turnlight::app {
namespace {

using ::testing::HasSubstr;

TEST(Verify, AGoodSession) {
  const TemporaryFolder folder;
  WriteSession(SmallConfig(), folder / "s");
  const Outcome outcome = RunProgram({"verify", folder / "s"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("good, 3 frames"));
  EXPECT_THAT(outcome.out, HasSubstr("content sha256 "));
}

TEST(Verify, OneBadFrameIsIncomplete) {
  const TemporaryFolder folder;
  WriteSession(SmallConfig(), folder / "s");
  const std::string image = ReadText(folder / "s/frames/001.png");
  WriteText(folder / "s/frames/001.png", image.substr(0, image.size() / 2));
  const Outcome outcome = RunProgram({"verify", folder / "s"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.out, HasSubstr("problem: frame 1"));
  EXPECT_THAT(outcome.out, HasSubstr("1 problem, 2 good frames"));
  EXPECT_THAT(outcome.out, ::testing::Not(HasSubstr("content sha256")));
}

TEST(Verify, AllFramesBadIsRefused) {
  const TemporaryFolder folder;
  WriteSession(SmallConfig(), folder / "s");
  for (const std::string name : {"000", "001", "002"})
    std::filesystem::remove(folder / ("s/frames/" + name + ".png"));
  const Outcome outcome = RunProgram({"verify", folder / "s"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.out, HasSubstr("3 problems, 0 good frames"));
}

// An estimate has as a note what verify remarks on; where there is none, its refusal says it.
TEST(Verify, PicturesThatContradictTheSession) {
  const TemporaryFolder folder;
  const std::string session = folder / "s";
  WriteSession(SmallConfig(), session);
  auto json = nlohmann::ordered_json::parse(ReadText(session + "/session.json"));
  for (auto& frame : json["frames"]) {
    frame.erase("sha256");
    const std::string file = session + "/" + frame["image"].get<std::string>();
    WriteText(file, rig::WithChunk(ReadText(file), rig::PngChunk("gAMA", rig::BigEndian(45455))));
  }
  WriteText(session + "/session.json", json.dump());
  const std::string said = "3 of 3 pictures, the first is frames/000.png: the gAMA chunk (45455)";
  const Outcome verify = RunProgram({"verify", session});
  EXPECT_EQ(verify.exit_code, 0);
  EXPECT_THAT(verify.out, HasSubstr("remark: " + said));
  const Outcome estimate = RunProgram({"estimate", session, "--out", folder / "r"});
  EXPECT_EQ(estimate.exit_code, 0);
  EXPECT_THAT(estimate.out, HasSubstr("encoding-contradicted: " + said));
  EXPECT_THAT(ReadText(folder / "r/result.json"), HasSubstr("\"encoding-contradicted\""));
  json["radiometry"]["black"] = 65000;
  WriteText(session + "/session.json", json.dump());
  const Outcome none = RunProgram({"estimate", session, "--out", folder / "none"});
  EXPECT_EQ(none.exit_code, 5);
  EXPECT_THAT(none.err, HasSubstr("Besides: " + said));
}

TEST(Verify, AFolderWithoutASessionSaysWhereItIs) {
  const TemporaryFolder folder;
  WriteSession(SmallConfig(), folder / "run/session");
  const Outcome run = RunProgram({"verify", folder / "run"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("run/session.json: cannot open"));
  EXPECT_THAT(run.err, HasSubstr("this is the folder of a run, its session is " +
                                 std::string(folder / "run/session")));
  const Outcome none = RunProgram({"verify", folder / "none"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("allowed is the folder of a session"));

  std::filesystem::rename(folder / "run/session/session.json",
                          folder / "run/session/journal.jsonl");
  const Outcome unfinished =
      RunProgram({"estimate", folder / "run/session", "--out", folder / "r"});
  EXPECT_EQ(unfinished.exit_code, 2);
  EXPECT_THAT(unfinished.err, HasSubstr("the capture was not finished, turnlight resume"));
}

TEST(Verify, ABadSessionIsRefused) {
  const TemporaryFolder folder;
  WriteSession(SmallConfig(), folder / "s");
  std::filesystem::remove(folder / "s/camera.cameramodel");
  const Outcome no_camera = RunProgram({"verify", folder / "s"});
  EXPECT_EQ(no_camera.exit_code, 2);
  EXPECT_THAT(no_camera.out + no_camera.err, HasSubstr("camera.cameramodel"));
  WriteText(folder / "s/session.json", "{");
  EXPECT_EQ(RunProgram({"verify", folder / "s"}).exit_code, 2);
}

// A lump on a table, small and quick.
rig::sim::SyntheticConfig LumpConfig() {
  rig::sim::SyntheticConfig config;
  config.seed = 4;
  config.target = rig::sim::Blob{40.0, 0.25, 48};
  config.motion = {rig::sim::MotionKind::kTable, 8, 45.0, 480.0, 25.0, 0.0};
  config.camera.width = 120;
  config.camera.height = 90;
  config.camera.focal_px = 360.0;
  config.samples_per_side = 2;
  config.sensor.noise_relative = 0.002;
  return config;
}

TEST(Verify, AgainstAModelNamesAFrameThatDoesNotBelong) {
  const TemporaryFolder folder;
  WriteSession(LumpConfig(), folder / "s");
  const Outcome good = RunProgram({"verify", folder / "s", "--model"});
  EXPECT_EQ(good.exit_code, 0) << good.out;
  EXPECT_THAT(good.out, HasSubstr("frames and poses belong together"));
  EXPECT_THAT(good.out, HasSubstr("with the angles reversed"));
  EXPECT_THAT(good.out, ::testing::ContainsRegex("model: fitted to small copies of the pictures, "
                                                 "[0-9]+ lights?.*, diffuse Lambert, specular "
                                                 ".+; it leaves 0\\.[0-9e-]+ of white"));

  std::filesystem::copy_file(folder / "s/frames/002.png", folder / "s/frames/005.png",
                             std::filesystem::copy_options::overwrite_existing);
  std::string session = ReadText(folder / "s/session.json");
  for (std::size_t at = 0; (at = session.find(",\"sha256\"")) != std::string::npos;)
    session.erase(at, session.find('}', at) - at);
  WriteText(folder / "s/session.json", session);
  const Outcome odd = RunProgram({"verify", folder / "s", "--model"});
  EXPECT_EQ(odd.exit_code, 3) << odd.out << odd.err;
  EXPECT_THAT(odd.out, HasSubstr("frames/005.png  <- has the same picture as frame 2"));
  EXPECT_THAT(odd.out, HasSubstr("problem: 1 frame does not belong to the others"));
}

}  // namespace
}  // namespace turnlight::app
