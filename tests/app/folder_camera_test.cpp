// Proves: a driver that is nothing but its own files and a line in the table captures a session
// through the real graph, and a replay of it opens no device; the simulation beside it, and what a
// real rig must say, are refused by name. Does not prove: anything of real hardware.
#include "tests/app/folder_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "app/capture_run.h"
#include "app/rig_config.h"
#include "rig/session/session.h"
#include "rig/sim/studio.h"
#include "rig/sim/synthetic_session.h"
#include "tests/app/program.h"
#include "tests/temporary_folder.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;

// It is where it is told to be, at once.
class ObedientTable : public rig::Turntable {
 public:
  Result<rig::DeviceIdentity> Open(rig::DeviceTime) override {
    return rig::DeviceIdentity{"turnlight", "obedient table", "1"};
  }
  Status Home(rig::DeviceTime) override { return {}; }
  Status MoveTo(double angle_deg, rig::DeviceTime) override {
    angle_deg_ = angle_deg;
    return {};
  }
  Result<rig::TableState> State(rig::DeviceTime now) override {
    return rig::TableState{now, rig::TableMotion::kIdle, angle_deg_, ""};
  }
  Status Halt(rig::DeviceTime) override { return {}; }

 private:
  double angle_deg_ = 0.0;
};

Result<rig::TableDevice> MakeObedientTable(StrictObject keys) {
  if (Status status = keys.Finish(); !status) return Forward(status);
  return rig::TableDevice{std::make_shared<ObedientTable>(), {}};
}

// The program's table, and two lines more.
Drivers Extended() {
  Drivers drivers = BuiltInDrivers();
  drivers.tables.push_back({"obedient", RealDriver<rig::TableDevice>(MakeObedientTable)});
  drivers.cameras.push_back({"folder", RealDriver<rig::CameraDevice>(MakeFolderCamera)});
  return drivers;
}

// Pictures of a lump on a table, with all that is known of them, taken for those of a laboratory.
class FolderCameraTest : public testing::Test {
 protected:
  void SetUp() override {
    rig::sim::SyntheticConfig config = SmallConfig();
    config.target = rig::sim::Blob{40.0, 0.3, 24};
    config.motion.kind = rig::sim::MotionKind::kTable;
    WriteSession(config, folder_ / "taken");
    const auto studio = rig::sim::BuildStudio(config);
    ASSERT_TRUE(studio) << studio.error().text;
    rig::RigCalibration calibration(studio->camera);
    calibration.geometry = std::get<calib::TurntableGeometry>(rig::sim::GeometryOf(config.motion));
    calibration.radiometry = studio->radiometry;
    calibration.devices = {{"turnlight", "folder camera", "frames"},
                           {"turnlight", "obedient table", "1"},
                           {80, 60},
                           {0, 0},
                           {1, 1},
                           ""};
    ASSERT_TRUE(rig::WriteRigCalibration(calibration, folder_ / "rig-calibration.json"));
  }

  std::string Rig() const {
    return "rig:\n  table: {driver: obedient}\n  camera: {driver: folder, path: " +
           (folder_ / "taken/frames") +
           ", size: [80, 60]}\n  calibration: rig-calibration.json\n"
           "  target: {shape: mesh, path: taken/target.ply}\n";
  }
  // With the graph of the main config.
  std::string Config(const std::string& rig) const {
    const std::string main =
        ReadText(fs::path(TURNLIGHT_SOURCE_DIR) / "configs/simulated_turntable.yaml");
    return "name: folder\ncapture: {count: 3, step_deg: 120}\n" + rig +
           main.substr(main.find("graph:\n"));
  }
  // What is said of a config whose rig has one text replaced.
  std::string Refusal(const std::string& what, const std::string& by) const {
    std::string rig = Rig();
    Replace(rig, what, by);
    const auto config = ParseRunConfig(Config(rig), "c.yaml", folder_ / "c.yaml");
    if (!config) return config.error().text;
    const auto made = MakeRig(*config, drivers_);
    return made ? "accepted" : made.error().text;
  }

  const TemporaryFolder folder_;
  const Drivers drivers_ = Extended();
};

TEST_F(FolderCameraTest, CapturesThroughTheRealGraph) {
  WriteText(folder_ / "c.yaml", Config(Rig()));
  const RunFolder run(folder_ / "run");
  ASSERT_EQ(RunCapture(folder_ / "c.yaml", run, CaptureGoal::kSession, drivers_), 0);
  const auto taken = rig::ReadSession(folder_ / "taken");
  const auto captured = rig::ReadSession(run.session());
  ASSERT_TRUE(captured) << captured.error().text;
  ASSERT_EQ(captured->frames.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto was = rig::ReadFrameImages(*taken, i), is = rig::ReadFrameImages(*captured, i);
    ASSERT_TRUE(is) << is.error().text;
    EXPECT_EQ(cv::norm(was->image, is->image, cv::NORM_INF), 0.0) << i;
    EXPECT_EQ(taken->frames[i].X_WC.rotation, captured->frames[i].X_WC.rotation) << i;
    EXPECT_EQ(taken->frames[i].X_WC.translation, captured->frames[i].X_WC.translation) << i;
    EXPECT_EQ(taken->frames[i].X_WT.rotation, captured->frames[i].X_WT.rotation) << i;
  }
  EXPECT_EQ(captured->camera->ToString(), taken->camera->ToString());
  EXPECT_EQ(ReadText(run.session() / "target.ply"), ReadText(folder_ / "taken/target.ply"));
  EXPECT_FALSE(fs::exists(run.session() / "truth.json"));  // nobody knows it

  EXPECT_EQ(ResumeCapture(run, drivers_), 0);  // nothing is left to do
  fs::rename(folder_ / "taken/frames", folder_ / "taken/away");
  const RunFolder again(folder_ / "again");
  EXPECT_EQ(ReplayCapture(folder_ / "run/log", again, drivers_), 0);
  EXPECT_EQ(ContentOf(again.session().string()), ContentOf(run.session().string()));
  const RunFolder gone(folder_ / "gone");
  EXPECT_EQ(RunCapture(folder_ / "c.yaml", gone, CaptureGoal::kSession, drivers_), 4);
  EXPECT_FALSE(gone.begun());
}

// What the config names counts as a part of it.
TEST_F(FolderCameraTest, AnotherCalibrationIsAnotherRig) {
  WriteText(folder_ / "c.yaml", Config(Rig()));
  const RunFolder run(folder_ / "run");
  ASSERT_EQ(RunCapture(folder_ / "c.yaml", run, CaptureGoal::kSession, drivers_), 0);
  EditCalibration(folder_ / "rig-calibration.json", "\"angle_offset\": {\"value\":0.0",
                  "\"angle_offset\": {\"value\":0.5");
  const RunFolder again(folder_ / "again");
  testing::internal::CaptureStderr();
  EXPECT_EQ(ReplayCapture(folder_ / "run/log", again, drivers_), 2);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("another \"rig\""));
  fs::remove(run.session() / rig::kSessionFile);
  testing::internal::CaptureStderr();
  EXPECT_EQ(ResumeCapture(run, drivers_), 2);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("config (SHA-256)"));
}

TEST_F(FolderCameraTest, OtherDevicesThanTheCalibrationsAreRefused) {
  EditCalibration(folder_ / "rig-calibration.json", "\"serial\":\"frames\"", "\"serial\":\"C-17\"");
  WriteText(folder_ / "c.yaml", Config(Rig()));
  const RunFolder run(folder_ / "run");
  testing::internal::CaptureStderr();
  EXPECT_EQ(RunCapture(folder_ / "c.yaml", run, CaptureGoal::kSession, drivers_), 2);
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              HasSubstr("rig-calibration.json: identity/camera/serial: \"C-17\", the camera that "
                        "was opened says \"frames\"; allowed is a calibration of these devices"));
  EXPECT_FALSE(fs::exists(run.root()));
  EXPECT_THAT(Refusal("size: [80, 60]", "size: [40, 30]"),
              HasSubstr("identity/camera/resolution: 80 x 60, this config's camera gives 40 x 30"));
}

TEST_F(FolderCameraTest, ASimulationBesideRealDevicesIsRefused) {
  EXPECT_THAT(Refusal("rig:\n", "simulation: {seed: 3}\nrig:\n"),
              EndsWith("c.yaml:3: simulation: it stands beside rig/table/driver: obedient, which "
                       "is no simulated device; allowed is a simulation only where both drivers "
                       "are simulated, mock for example"));
  EXPECT_THAT(Refusal("{driver: obedient}", "{driver: mock}"),
              EndsWith("rig/table/driver: mock, a simulated device, beside rig/camera/driver: "
                       "folder; allowed are two simulated devices or two real ones"));
  EXPECT_THAT(
      Refusal("rig:\n  table: {driver: obedient}", "simulation: {}\nrig:\n  table: {driver: mock}"),
      HasSubstr("simulation: it stands beside rig/camera/driver: folder"));
}

TEST_F(FolderCameraTest, WhatIsKnownOfARealRigHasToBeSaid) {
  EXPECT_EQ(Refusal("rig:", "rig:"), "accepted");
  EXPECT_THAT(Refusal("  calibration: rig-calibration.json\n", ""),
              HasSubstr("rig/calibration: this key is missing, a rig that is not simulated needs "
                        "it; allowed is the path of a rig-calibration.json"));
  EXPECT_THAT(Refusal("  target: {shape: mesh, path: taken/target.ply}\n", ""),
              HasSubstr("rig/target: this key is missing, a rig that is not simulated needs it"));
  EXPECT_THAT(Refusal("calibration: rig-calibration.json", "calibration: other.json"),
              AllOf(HasSubstr("rig/calibration: "), HasSubstr("other.json")));
  EXPECT_THAT(Refusal("calibration: rig-calibration.json", "calibration: 7"),
              HasSubstr("rig/calibration: 7, allowed is the path of a rig-calibration.json, or an "
                        "object with its keys"));
  EXPECT_THAT(Refusal("taken/target.ply", "taken/none.ply"), HasSubstr("rig/target/path: "));
  EXPECT_THAT(Refusal("driver: folder", "driver: flder"),
              HasSubstr("rig/camera/driver: \"flder\", allowed is one of mock, aravis, folder"));
  EXPECT_THAT(Refusal("driver: folder, ", ""), HasSubstr("rig/camera/driver: this key is missing"));
  EXPECT_THAT(Refusal("size: [80, 60]", "size: [80, 60], fps: 3"),
              HasSubstr("rig/camera/fps: unknown key"));
  EXPECT_THAT(Refusal("  target:", "  length_unit: m\n  target:"),
              HasSubstr("rig/length_unit: m, allowed is the calibration's, mm"));
}

}  // namespace
}  // namespace turnlight::app
