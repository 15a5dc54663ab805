// Proves: how a config names its devices and what beside them is refused, with the words; that a
// simulated rig is known from its simulation or from a calibration that is named; that a config of
// the old shape is refused with one of the new that is good, on every way in. Does not prove: what
// is captured then; run_test and folder_camera_test do.
#include "app/rig_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/program.h"
#include "tests/temporary_folder.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

std::string MainConfig() {
  return ReadText(fs::path(TURNLIGHT_SOURCE_DIR) / "configs/simulated_turntable.yaml");
}

// The main config with another rig and simulation.
std::string WithRig(const std::string& rig) {
  const std::string text = MainConfig();
  const std::size_t begin = text.find("\nrig:") + 1, end = text.find("\ngraph:") + 1;
  return text.substr(0, begin) + rig + text.substr(end);
}

Result<rig::RigSetup> Make(const std::string& text, const fs::path& folder = {}) {
  const auto config = ParseRunConfig(text, "c.yaml", folder / "c.yaml");
  if (!config) return Forward(config);
  return MakeRig(*config);
}
std::string Refusal(const std::string& text, const fs::path& folder = {}) {
  const auto made = Make(text, folder);
  return made ? "accepted" : made.error().text;
}
std::string Refusal(std::string text, const std::string& what, const std::string& by) {
  Replace(text, what, by);
  return Refusal(text);
}

// As configs were before devices were named apart.
constexpr char kOldRig[] = R"(rig:
  driver: mock
  table: {max_speed_deg_s: 30, backlash_deg: 0.05}
  camera:
    reference_exposure_us: 8000
    scene:
      target: {shape: sphere, radius: 50}
      motion: {kind: orbit, distance: 420, elevation_deg: 30}
)";

TEST(RigConfig, ASimulatedRigIsKnownFromItsSimulation) {
  const auto rig = Make(MainConfig());
  ASSERT_TRUE(rig) << rig.error().text;
  EXPECT_EQ(rig->length_unit, "mm");
  EXPECT_EQ(rig->camera.format.size, cv::Size(320, 240));
  EXPECT_EQ(rig->camera.format.depth, CV_16U);
  EXPECT_EQ(rig->camera.readout_s, 0.015);
  EXPECT_EQ(rig->table.kinematics.speed_deg_per_s, 30.0);
  EXPECT_EQ(rig->table.kinematics.acceleration_deg_per_s2, 120.0);
  EXPECT_EQ(rig->known.radiometry.reference_exposure_us, 8000.0);
  EXPECT_NEAR(rig->known.noise.read_noise_dn, 0.002 * 65535.0, 1e-9);
  EXPECT_NEAR(rig->known.noise.dn_per_electron, 0.004 * 0.004 * 65535.0, 1e-9);
  EXPECT_TRUE(std::holds_alternative<calib::TurntableGeometry>(rig->known.geometry));
  EXPECT_TRUE(std::holds_alternative<calib::MeshShape>(rig->target.shape));
  EXPECT_THAT(rig->truth.value_or(""), HasSubstr("the simulated rig of simulated_turntable"));
  EXPECT_FALSE(rig->identity);  // nothing was opened
}

TEST(RigConfig, WordsOfTheRefusals) {
  const std::string config = MainConfig();
  EXPECT_THAT(Refusal(config, "camera: {driver: mock}", "camera: {driver: magic}"),
              HasSubstr("rig/camera/driver: \"magic\", allowed is one of mock"));
  EXPECT_THAT(Refusal(config, "table: {driver: mock, ", "table: {driver: hand, "),
              HasSubstr("rig/table/driver: \"hand\", allowed is one of mock"));
  EXPECT_THAT(Refusal(config, "table: {driver: mock, ", "table: {"),
              HasSubstr("rig/table/driver: this key is missing"));
  EXPECT_THAT(Refusal(config, "  camera: {driver: mock}\n", ""),
              HasSubstr("rig/camera: this key is missing"));
  EXPECT_THAT(Refusal(config, "{driver: mock, ", "{driver: mock, backlash_deg: 1, "),
              HasSubstr("rig/table/backlash_deg: unknown key"));
  EXPECT_THAT(Refusal(config, "  length_unit: mm", "  length_unit: m m"),
              HasSubstr("rig/length_unit: \"m m\", allowed is a word without spaces"));
  EXPECT_THAT(Refusal(config, "  length_unit: mm", "  lights: 2"),
              HasSubstr("rig/lights: unknown key"));
  EXPECT_THAT(Refusal(config, "distance: 480", "distance: 1"),
              HasSubstr("simulation/motion/distance: 1"));
}

TEST(RigConfig, MockDevicesNeedASimulation) {
  const std::string refusal =
      Refusal(WithRig("rig:\n  table: {driver: mock}\n  camera: {driver: mock}\n"));
  EXPECT_THAT(refusal, AllOf(StartsWith("c.yaml:"),
                             HasSubstr("rig/table/driver: mock needs the section simulation beside "
                                       "rig, as in\n"),
                             HasSubstr("  simulation:\n")));
  EXPECT_EQ(Refusal(WithRig("rig:\n  table: {driver: mock}\n  camera: {driver: mock}\n"
                            "simulation: {}\n")),
            "accepted");
}

// Its own example, given back.
TEST(RigConfig, TheOldShapeIsRefusedWithAGoodExampleOfTheNew) {
  const std::string refusal = Refusal(WithRig(kOldRig));
  EXPECT_THAT(refusal, StartsWith("c.yaml: the section rig is of the old shape"));
  const std::size_t begin = refusal.find("  rig:\n"), end = refusal.find("configs/");
  ASSERT_LT(begin, end);
  std::string example;
  for (std::size_t at = begin; at < end;) {
    const std::size_t next = refusal.find('\n', at) + 1;
    example += refusal.substr(at + 2, next - at - 2);
    at = next;
  }
  EXPECT_EQ(Refusal(WithRig(example)), "accepted") << example;
  EXPECT_THAT(Refusal(WithRig("rig:\n  table: {driver: mock}\n  camera: {scene: {seed: 1}}\n")),
              HasSubstr("old shape"));
  EXPECT_THAT(Refusal(WithRig("rig:\n  table: {driver: mock}\n  faults: {}\n")),
              HasSubstr("old shape"));
}

TEST(RigConfig, OldRunsAreRefusedWithTheReason) {
  const TemporaryFolder folder;
  WriteText(folder / "old.yaml", WithRig(kOldRig));
  for (const char* command : {"plan", "graph"})
    EXPECT_EQ(RunProgram({command, folder / "old.yaml"}).exit_code, 2);
  const Outcome check = RunProgram({"config", "check", folder / "old.yaml"});
  EXPECT_EQ(check.exit_code, 2);
  EXPECT_THAT(check.err, HasSubstr("old shape"));

  WriteText(folder / "small.yaml", SmallRunConfig());
  const std::string run = folder / "run";
  ASSERT_EQ(RunProgram({"capture", folder / "small.yaml", "--out", run}).exit_code, 0);
  fs::remove(fs::path(run) / "session/session.json");
  WriteText(run + "/config.yaml", WithRig(kOldRig));
  WriteText(run + "/run.json", R"({"format":"turnlight-run","version":1,"command":"capture"})");
  for (const auto& arguments : {std::vector<std::string>{"resume", run},
                                {"replay", run + "/log", "--out", folder / "again"}}) {
    const Outcome outcome = RunProgram(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr("run/config.yaml: the section rig is of the old shape"),
                      HasSubstr("A run that was begun with the old shape is resumed and replayed "
                                "by the version of turnlight that began it")));
  }
  EXPECT_FALSE(fs::exists(folder / "again"));
}

// Without the line of the calibration.
std::string SessionText(const fs::path& session) {
  std::string text = ReadText((session / "session.json").string());
  const std::size_t begin = text.find(" \"calibration\"");
  if (begin != std::string::npos) text.erase(begin, text.find('\n', begin) + 1 - begin);
  return text;
}

// What the simulation knows, written down, named, and captured with: the same session, which keeps
// a copy of the calibration.
TEST(RigConfig, ACalibrationOfTheSimulationItselfGivesTheSameBytes) {
  const TemporaryFolder folder;
  std::string text = MainConfig();
  Replace(text, "count: 36", "count: 3");
  Replace(text, "size: [320, 240], focal_px: 640", "size: [80, 60], focal_px: 160");
  const auto made = Make(text);
  ASSERT_TRUE(made) << made.error().text;
  rig::RigCalibration calibration(made->known.lens);
  calibration.geometry = std::get<calib::TurntableGeometry>(made->known.geometry);
  calibration.radiometry = made->known.radiometry;
  calibration.devices = {{"turnlight", "mock camera", "MOCK-CAMERA-1"},
                         {"turnlight", "mock turntable", "MOCK-TABLE-1"},
                         {80, 60},
                         {0, 0},
                         {1, 1},
                         ""};
  fs::create_directory(folder / "known");
  ASSERT_TRUE(rig::WriteRigCalibration(calibration, folder / "known/rig.json"));
  WriteText(folder / "plain.yaml", text);
  Replace(text, "  length_unit: mm", "  calibration: known/rig.json");
  WriteText(folder / "known.yaml", text);
  for (const std::string name : {"plain", "known"}) {
    const Outcome outcome =
        RunProgram({"capture", folder / (name + ".yaml"), "--out", folder / name + "_run"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  const fs::path known = folder / "known_run/session", plain = folder / "plain_run/session";
  EXPECT_EQ(SessionText(known), SessionText(plain)) << "checksums of the pictures included";
  EXPECT_NE(ReadText((known / "session.json").string()),
            ReadText((plain / "session.json").string()));
  EXPECT_TRUE(fs::exists(known / "rig-calibration.json"));
  EXPECT_EQ(RunProgram({"verify", known.string()}).exit_code, 0);

  // Another than the truth is what the session says; the simulation keeps its own.
  calibration.geometry.X_WC.translation.x() += 1.0;
  calibration.length_unit = "cm";
  ASSERT_TRUE(rig::WriteRigCalibration(calibration, folder / "known/rig.json"));
  const auto other = Make(text, folder.path());
  ASSERT_TRUE(other) << other.error().text;
  EXPECT_EQ(calib::PosesAt(other->known.geometry, 30.0).X_WC.translation.x(),
            calibration.geometry.X_WC.translation.x());
  EXPECT_EQ(other->length_unit, "cm");
  EXPECT_EQ(other->truth, made->truth);
  Replace(text, "motion: {kind: table", "motion: {kind: orbit");
  EXPECT_THAT(Refusal(text, folder.path()),
              EndsWith("rig/calibration: it is of a rig whose target turns, "
                       "simulation/motion/kind is orbit; allowed is kind: table, or no "
                       "calibration"));
}

TEST(RigConfig, ATargetThatIsNamedIsWhatTheSessionSays) {
  std::string text = MainConfig();
  Replace(text, "  length_unit: mm", "  target: {shape: sphere, radius: 12}");
  const auto rig = Make(text);
  ASSERT_TRUE(rig) << rig.error().text;
  EXPECT_EQ(std::get<calib::SphereShape>(rig->target.shape).radius, 12.0);
  EXPECT_EQ(std::get<calib::SphereShape>(rig->target.copy).radius, 12.0);
  Replace(text, "{shape: sphere, radius: 12}", "{shape: plane, size: [30, 20], sides: 2}");
  EXPECT_EQ(std::get<calib::PlaneShape>(Make(text)->target.shape).sides, 2);
  EXPECT_THAT(Refusal(text, "{shape: plane, size: [30, 20], sides: 2}", "{shape: cube}"),
              HasSubstr("rig/target/shape: \"cube\", allowed is one of sphere, plane, mesh"));
}

}  // namespace
}  // namespace turnlight::app
