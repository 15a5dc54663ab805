// Proves, with the real program on sessions and captures of the simulator: a calibration that is
// true is called so with exit code 0, a camera that was moved is found with exit code 3, by a board
// and by the target's outlines; check.json and check.png are written, the same for any number of
// threads; what does not fit together is refused. How right the numbers are is drift_test's.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/angles.h"
#include "base/file.h"
#include "calib/camera_model.h"
#include "calib/rig_geometry.h"
#include "rig/rig_calibration.h"
#include "rig/session/image_file.h"
#include "rig/session/raw_capture.h"
#include "rig/session/session.h"
#include "rig/sim/synthetic_session.h"
#include "tests/app/program.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

constexpr char kCheckedRig[] =
    "capture: {step_deg: 120, count: 3, settle_ms: 0, retries: 1}\n"
    "rig:\n"
    "  table: {driver: mock, max_speed_deg_s: 10000, acceleration_deg_s2: 100000, "
    "home_speed_deg_s: 10000}\n"
    "  camera: {driver: mock, readout_ms: 1}\n"
    "simulation:\n"
    "  motion: {kind: table, distance: 420, elevation_deg: 50}\n"
    "  geometry: {angle_noise_deg: 0.02}\n"
    "  camera: {size: [480, 360], focal_px: 900}\n"
    "  sensor: {bits: 8, noise_relative: 0.01}\n"
    "  table: {settle_ms: 0}\n"
    "  prop: {kind: board, board: {columns: 7, rows: 6, spacing: 12}, offset: [15, 5, 0]}\n";

Eigen::MatrixXd PoseCovariance() {
  Eigen::VectorXd sigma(6);
  sigma << 1e-4, 1e-4, 1e-4, 0.02, 0.02, 0.02;
  return sigma.cwiseAbs2().asDiagonal();
}

void SetCovariances(rig::RigCalibration& rig) {
  const auto count = static_cast<Eigen::Index>(rig.lens.intrinsics().size());
  rig.covariances.camera_model = Eigen::MatrixXd::Identity(count, count) * 0.01;
  rig.covariances.X_WC = rig.covariances.X_AT = PoseCovariance();
  rig.covariances.X_WA = Eigen::MatrixXd::Zero(6, 6);
  rig.covariances.angle_scale = Eigen::MatrixXd::Constant(1, 1, 1e-8);
  rig.covariances.angle_offset = Eigen::MatrixXd::Zero(1, 1);
}

void TurnStored(rig::RigCalibration& rig, double degrees) {
  calib::Pose& X_WC = rig.geometry.X_WC;
  X_WC.rotation = calib::Turn(X_WC.rotation.col(1), DegToRad(degrees)).rotation * X_WC.rotation;
}

// A board on a table, three pictures, and the calibration as it is in truth.
struct BoardScene {
  TemporaryFolder folder;
  rig::RigCalibration rig{calib::CameraModel::Pinhole(480, 360, 900, 900, 239.5, 179.5)};

  BoardScene() {
    WriteText(folder / "rig.yaml", kCheckedRig);
    const Outcome captured =
        RunProgram({"calibrate", "capture", folder / "rig.yaml", "--out", folder / "board"});
    EXPECT_EQ(captured.exit_code, 0) << captured.err;
    const auto capture = rig::ReadRawCapture(folder / "board");
    EXPECT_TRUE(capture);
    if (capture) rig.devices = capture->devices;
    rig.geometry.X_WC = calib::LookAtOrigin(0.0, DegToRad(50.0), 420.0);
    rig.target_placed = false;
    SetCovariances(rig);
    rig.covariances.X_AT.reset();
  }

  Outcome Check(const std::string& name, const std::vector<std::string>& more = {}) const {
    EXPECT_TRUE(rig::WriteRigCalibration(rig, folder / (name + ".json")));
    std::vector<std::string> line{"calibrate",
                                  "check",
                                  folder / "board",
                                  "--calibration",
                                  folder / (name + ".json"),
                                  "--board",
                                  "7x6",
                                  "--square-mm",
                                  "12",
                                  "--out",
                                  folder / name};
    line.insert(line.end(), more.begin(), more.end());
    return RunProgram(line);
  }
};

TEST(CalibrateCheck, ABoardSaysWhetherTheCameraMoved) {
  BoardScene scene;
  const Outcome good = scene.Check("good");
  EXPECT_EQ(good.exit_code, 0) << good.err << good.out;
  EXPECT_THAT(good.out, AllOf(HasSubstr("still true"), HasSubstr("3 used")));
  TurnStored(scene.rig, 0.1);
  const Outcome turned = scene.Check("turned", {"--threads", "1"});
  EXPECT_EQ(turned.exit_code, 3) << turned.err << turned.out;
  EXPECT_THAT(turned.out, AllOf(HasSubstr("drifted: the camera turned by"),
                                HasSubstr("turnlight calibrate axis")));
  const json check = json::parse(ReadText(scene.folder / "turned/check.json"));
  EXPECT_EQ(check["format"], "turnlight-check");
  EXPECT_EQ(check["found"]["causes"], json::array({"camera"}));
  EXPECT_TRUE(rig::ReadImage(scene.folder / "turned/check.png"));
  const std::string before = ReadText(scene.folder / "turned/check.json");
  ASSERT_EQ(scene.Check("turned", {"--threads", "2"}).exit_code, 3);
  EXPECT_EQ(ReadText(scene.folder / "turned/check.json"), before);
}

TEST(CalibrateCheck, RefusesABoardOfAnotherRig) {
  BoardScene scene;
  EXPECT_THAT(scene.Check("size", {"--angle-sigma-deg", "-1"}).err, HasSubstr("--angle-sigma-deg"));
  const Outcome none = RunProgram({"calibrate", "check", scene.folder / "board", "--calibration",
                                   scene.folder / "size.json", "--board", "5x4", "--square-mm",
                                   "12", "--out", scene.folder / "none"});
  EXPECT_EQ(none.exit_code, 2) << none.err;
  EXPECT_THAT(none.err, HasSubstr("is it --board 7x6?"));
  scene.rig.devices.camera.serial = "another";
  const Outcome other = scene.Check("other");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("identity/camera/serial: \"another\""));
  EXPECT_FALSE(fs::exists(scene.folder / "other"));
}

// A ball on a table, four pictures, no masks.
struct BallScene {
  TemporaryFolder folder;
  std::string session = folder / "session";
  rig::RigCalibration rig = Written();

  rig::RigCalibration Written() const {
    WriteSession(BallOnTableConfig(4), session);
    const auto taken = rig::ReadSession(session);
    rig::RigCalibration rig(*taken->camera);
    rig.geometry.X_WC = taken->frames[0].X_WC;
    rig.devices.resolution = {320, 240};
    SetCovariances(rig);
    return rig;
  }

  Outcome Check(const std::string& name) const {
    EXPECT_TRUE(rig::WriteRigCalibration(rig, folder / (name + ".json")));
    return RunProgram({"calibrate", "check", session, "--calibration", folder / (name + ".json"),
                       "--out", folder / name});
  }
};

TEST(CalibrateCheck, OutlinesSayWhetherTheTargetMoved) {
  BallScene scene;
  const Outcome good = scene.Check("good");
  EXPECT_EQ(good.exit_code, 0) << good.err << good.out;
  EXPECT_THAT(good.out, HasSubstr("still true"));
  scene.rig.geometry.X_AT.translation.x() += 2.0;
  const Outcome moved = scene.Check("moved");
  EXPECT_EQ(moved.exit_code, 3) << moved.err << moved.out;
  EXPECT_THAT(moved.out, AllOf(HasSubstr("drifted: the target moved by"),
                               HasSubstr("turnlight calibrate target")));
  EXPECT_TRUE(rig::ReadImage(scene.folder / "moved/check.png"));
  scene.rig.target_placed = false;
  scene.rig.covariances.X_AT.reset();
  const Outcome unplaced = scene.Check("unplaced");
  EXPECT_EQ(unplaced.exit_code, 2);
  EXPECT_THAT(unplaced.err, AllOf(HasSubstr("X_AT"), HasSubstr("turnlight calibrate target")));
}

}  // namespace
}  // namespace turnlight::app
