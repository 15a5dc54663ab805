// Proves that `synthesize` writes a session that `verify` finds good, the same one each time, that
// it never writes over anything, that Ctrl-C leaves no half session, and that `config` shows what
// was used. Does not prove what is in the pictures; tests/rig/sim does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <opencv2/core.hpp>
#include <regex>
#include <thread>

#include "rig/session/session.h"
#include "rig/sim/synthetic_config.h"
#include "rig/sim/synthetic_session.h"
#include "tests/app/program.h"

namespace turnlight::app {
namespace {

using ::testing::HasSubstr;

constexpr const char* kConfig =
    "seed: 3\nmotion: {frames: 2}\ncamera: {size: [64, 48], focal_px: 120}\n"
    "sensor: {noise_relative: 0.01}\n";

TEST(Synthesize, WritesAGoodSessionTheSameEachTime) {
  const TemporaryFolder folder;
  WriteText(folder / "c.yaml", kConfig);
  std::string first;
  for (const std::string threads : {"1", "7"}) {
    const Outcome made = RunProgram(
        {"synthesize", folder / "c.yaml", "--out", folder / threads, "--threads", threads});
    EXPECT_EQ(made.exit_code, 0) << made.err;
    const Outcome verified = RunProgram({"verify", folder / threads});
    EXPECT_EQ(verified.exit_code, 0) << verified.out;
    EXPECT_THAT(verified.out, HasSubstr("2 frames"));
    const std::string hash = verified.out.substr(verified.out.find("sha256"));
    if (first.empty()) first = hash;
    EXPECT_EQ(hash, first);
  }
}

TEST(Synthesize, NeverWritesOver) {
  const TemporaryFolder folder;
  WriteText(folder / "c.yaml", kConfig);
  const Outcome in_use = RunProgram({"synthesize", folder / "c.yaml", "--out", folder.path()});
  EXPECT_EQ(in_use.exit_code, 2);
  EXPECT_THAT(in_use.err, HasSubstr("not empty"));
  const Outcome file = RunProgram({"synthesize", folder / "c.yaml", "--out", folder / "c.yaml"});
  EXPECT_EQ(file.exit_code, 2);
  EXPECT_THAT(file.err, HasSubstr("is a file"));
}

TEST(Synthesize, RemarksOnClipping) {
  const TemporaryFolder folder;
  WriteText(folder / "c.yaml",
            std::string(kConfig) + "lights: [{direction: [0, 0, 1], intensity: 9}]\n");
  const Outcome outcome = RunProgram({"synthesize", folder / "c.yaml", "--out", folder / "s"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("remark: "));
  EXPECT_THAT(outcome.err, HasSubstr("clipped"));
}

TEST(Synthesize, CtrlCLeavesNoSession) {
  const TemporaryFolder folder;
  WriteText(folder / "c.yaml", "motion: {frames: 2000}\ncamera: {size: [64, 48], focal_px: 120}\n");
  const pid_t process = Start({"synthesize", folder / "c.yaml", "--out", folder / "s"});
  for (int i = 0; i < 3000 && !std::filesystem::exists(folder / "s/frames/001.png"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ASSERT_EQ(::kill(process, SIGINT), 0);
  EXPECT_EQ(Finish(process), 130);
  EXPECT_TRUE(std::filesystem::exists(folder / "s/frames/001.png"));
  EXPECT_FALSE(std::filesystem::exists(folder / "s/session.json"));
  // Every file is whole: none has a temporary beside it.
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "s"))
    EXPECT_TRUE(entry.is_directory() || entry.path().extension() == ".png") << entry.path();
}

TEST(Config, ChecksAndShows) {
  const TemporaryFolder folder;
  WriteText(folder / "c.yaml", kConfig);
  EXPECT_EQ(RunProgram({"config", "check", folder / "c.yaml"}).exit_code, 0);
  const Outcome shown = RunProgram({"config", "show", folder / "c.yaml"});
  EXPECT_EQ(shown.exit_code, 0);
  EXPECT_THAT(shown.out, HasSubstr("seed: 3\n"));
  EXPECT_THAT(shown.out, HasSubstr("samples_per_side: 5\n"));  // a default
  WriteText(folder / "shown.yaml", shown.out);
  EXPECT_EQ(RunProgram({"config", "show", folder / "shown.yaml"}).out, shown.out);
}

TEST(Config, RefusesByFileLineAndKey) {
  const TemporaryFolder folder;
  WriteText(folder / "c.yaml", "seed: 3\nmotion: {frames: 0}\n");
  for (const std::string command : {"check", "show"}) {
    const Outcome outcome = RunProgram({"config", command, folder / "c.yaml"});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("c.yaml:2: motion/frames: 0"));
    EXPECT_EQ(outcome.out, "");
  }
}

TEST(Config, AConfigOfTheOtherKindIsCalledThat) {
  const TemporaryFolder folder;
  const std::string configs = TURNLIGHT_SOURCE_DIR "/configs/";
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"config", "show"}, {"synthesize", "--out", folder / "s"}}) {
    std::vector<std::string> all = words;
    all.push_back(configs + "simulated_turntable.yaml");
    const Outcome outcome = RunProgram(all);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("a config for turnlight run, allowed is one for turnlight "
                                       "synthesize"));
  }
  const Outcome plan = RunProgram({"plan", configs + "synthetic_sphere.yaml"});
  EXPECT_EQ(plan.exit_code, 2);
  EXPECT_THAT(plan.err, HasSubstr("synthetic_sphere.yaml: a config for turnlight synthesize, "
                                  "allowed is one for turnlight run"));
  // A misspelt graph is told by its line and the word that was meant.
  std::string text = ReadText(configs + "simulated_turntable.yaml");
  Replace(text, "\ngraph:", "\ngrap:");
  WriteText(folder / "grap.yaml", text);
  const Outcome check = RunProgram({"config", "check", folder / "grap.yaml"});
  EXPECT_EQ(check.exit_code, 2);
  EXPECT_THAT(check.err, HasSubstr("grap: unknown key"));
  EXPECT_THAT(check.err, HasSubstr("did you mean \"graph\"?"));
  // A rig alone is a config for other commands.
  text.erase(text.find("\ngrap:"));
  WriteText(folder / "rig.yaml", text);
  EXPECT_THAT(RunProgram({"config", "check", folder / "rig.yaml"}).err,
              HasSubstr("home, jog, snap and doctor do without it"));
}

TEST(Config, TheExamplesAreGood) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(TURNLIGHT_SOURCE_DIR "/configs")) {
    if (entry.path().extension() != ".yaml") continue;
    if (entry.path().filename() == "compare_tolerance.yaml") continue;   // compare_test has it
    if (entry.path().filename().string().starts_with("rig_")) continue;  // below
    ++count;
    const Outcome outcome = RunProgram({"config", "check", entry.path()});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  EXPECT_GE(count, 4);
}

// What only an owner can give is made up: a calibration of pictures like those of the config.
TEST(Config, TheExamplesOfRealRigsAreGoodBesideACalibration) {
  struct {
    const char *file, *size, *roi_offset;
  } const rigs[] = {{"rig_grbl_gige.yaml", "[1920, 1200]", "[0,0]"},
                    {"rig_zaber_usb3.yaml", "[1440, 960]", "[240,120]"}};
  const std::string configs = TURNLIGHT_SOURCE_DIR "/configs/";
  for (const auto& rig : rigs) {
    const TemporaryFolder folder;
    WriteText(folder / rig.file, ReadText(configs + rig.file));
    const Outcome without = RunProgram({"config", "check", folder / rig.file});
    EXPECT_EQ(without.exit_code, 2);
    EXPECT_THAT(without.err, HasSubstr("rig/calibration: "));
    EXPECT_THAT(without.err, HasSubstr("turnlight simulate SIM.yaml --calibration FILE"));
    EXPECT_THAT(without.err, HasSubstr("docs/calibrating.md"));
    WriteText(folder / "sim.yaml", std::string("camera: {size: ") + rig.size +
                                       ", focal_px: 3000}\nmotion: {kind: table}\ndevices:\n  "
                                       "table: {firmware: grbl, link: unused}\n  camera: "
                                       "{pixel_format: Mono12}\n");
    const Outcome made = RunProgram(
        {"simulate", folder / "sim.yaml", "--calibration", folder / "rig-calibration.json"});
    EXPECT_EQ(made.exit_code, 0) << made.err;
    EditCalibration(folder / "rig-calibration.json", "\"roi_offset\":[0,0]",
                    std::string("\"roi_offset\":") + rig.roi_offset);
    WriteText(folder / "target.ply", ReadText(configs + "hil/target.ply"));
    const Outcome checked = RunProgram({"config", "check", folder / rig.file});
    EXPECT_EQ(checked.exit_code, 0) << checked.err;
    // So is what it shows as a remark.
    const std::string all = std::regex_replace(ReadText(configs + rig.file),
                                               std::regex("\n    # ([a-z_]+:)"), "\n    $1");
    WriteText(folder / rig.file, std::regex_replace(all, std::regex("\n    port: [^\n]*"), ""));
    const Outcome remarks = RunProgram({"config", "check", folder / rig.file});
    EXPECT_EQ(remarks.exit_code, 0) << remarks.err;
  }
}

// From the loop to a rig: other devices, times and plan, the same graph.
TEST(Config, ARealRigHasTheGraphOfTheLoop) {
  const auto graph_of = [](const std::string& name) {
    const std::string text = ReadText(TURNLIGHT_SOURCE_DIR "/configs/" + name);
    return std::regex_replace(text.substr(text.find("\ngraph:")),
                              std::regex("lost_timeout_s: [^\n]*"), "");
  };
  EXPECT_EQ(graph_of("rig_grbl_gige.yaml"), graph_of("hil_grbl.yaml"));
  EXPECT_EQ(graph_of("rig_zaber_usb3.yaml"), graph_of("hil_zaber.yaml"));
}

// To a step of the pictures, not to the byte: the processor's sine may differ in the last bit.
TEST(Config, TheShippedSessionIsTheOneItsConfigMakes) {
  const std::string configs = TURNLIGHT_SOURCE_DIR "/configs/";
  EXPECT_EQ(RunProgram({"verify", configs + "example_session"}).exit_code, 0);
  const auto session = rig::ReadSession(configs + "example_session");
  ASSERT_TRUE(session) << session.error().text;
  const auto config = rig::sim::ReadSyntheticConfig(configs + "example_session.yaml");
  ASSERT_TRUE(config) << config.error().text;
  const auto made = rig::sim::SynthesizeInMemory(*config);
  ASSERT_TRUE(made) << made.error().text;
  ASSERT_EQ(session->frames.size(), made->frames.size());
  for (std::size_t i = 0; i < made->frames.size(); ++i) {
    const auto images = rig::ReadFrameImages(*session, i);
    ASSERT_TRUE(images) << images.error().text;
    ASSERT_EQ(images->image.type(), made->frames[i].image.type());
    EXPECT_LE(cv::norm(images->image, made->frames[i].image, cv::NORM_INF), 1.0);
    EXPECT_LE(cv::norm(images->image, made->frames[i].image, cv::NORM_L1), 10.0);
    EXPECT_TRUE(session->frames[i].X_WC.rotation.isApprox(made->frames[i].X_WC.rotation, 1e-12));
  }
}

}  // namespace
}  // namespace turnlight::app
