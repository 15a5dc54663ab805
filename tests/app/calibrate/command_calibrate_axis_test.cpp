// Proves, with the real program and mock devices whose axis is not where it seems: pictures of a
// board on the turning table become a rig's calibration within its sigmas, with its devices, beside
// pictures; the radiometry of a calibration that is there stays; a rig whose target has no place
// yet does not capture; what does not fit together is refused. Does not prove: that the sigmas
// cover the errors (axis_study).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "base/angles.h"
#include "base/file.h"
#include "calib/camera_model.h"
#include "calib/rig_geometry.h"
#include "rig/rig_calibration.h"
#include "tests/app/program.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kTiltDeg = 2.0, kScale = 1.002;

constexpr char kBoardRig[] =
    "capture: {step_deg: 30, count: 13, settle_ms: 0, retries: 1}\n"
    "rig:\n"
    "  table: {driver: mock, max_speed_deg_s: 10000, acceleration_deg_s2: 100000, "
    "home_speed_deg_s: 10000}\n"
    "  camera: {driver: mock, readout_ms: 1}\n"
    "simulation:\n"
    "  motion: {kind: table, distance: 420, elevation_deg: 50}\n"
    "  geometry: {axis_tilt_deg: [2, 0], angle_scale: 1.002, angle_noise_deg: 0.05}\n"
    "  camera: {size: [480, 360], focal_px: 900}\n"
    "  sensor: {bits: 8, noise_relative: 0.01}\n"
    "  table: {settle_ms: 0}\n"
    "  prop: {kind: board, board: {columns: 7, rows: 6, spacing: 12}, offset: [15, 5, 0]}\n";

class CalibrateAxisCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    WriteText(*folder_ / "rig.yaml", kBoardRig);
    const Outcome outcome =
        RunProgram({"calibrate", "capture", *folder_ / "rig.yaml", "--out", *folder_ / "board"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    fs::create_directory(*folder_ / "lens");
    WriteText(*folder_ / "lens/camera.cameramodel",
              calib::CameraModel::Pinhole(480, 360, 900, 900, 239.5, 179.5).ToString());
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static Outcome Calibrate(const std::string& out, const std::vector<std::string>& more = {},
                           const std::string& board = "7x6") {
    std::vector<std::string> line{
        "calibrate", "axis",     *folder_ / "board", "--board", board, "--square-mm",
        "12",        "--camera", *folder_ / "lens",  "--out",   out};
    line.insert(line.end(), more.begin(), more.end());
    return RunProgram(line);
  }

  static TemporaryFolder* folder_;
};
TemporaryFolder* CalibrateAxisCommand::folder_ = nullptr;

TEST_F(CalibrateAxisCommand, FindsTheAxisOfASimulatedRig) {
  const fs::path out = *folder_ / "rig/rig-calibration.json";
  const Outcome outcome = Calibrate(out, {"--lens", "50 mm, f/8"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("13 of 13 used"), HasSubstr("verdict"), HasSubstr("closure"),
                    HasSubstr("without its covariance"), HasSubstr("turnlight calibrate target")));
  for (const char* name : {"rig-calibration-axis-views.png", "rig-calibration-axis-plan.png"})
    EXPECT_TRUE(fs::exists(out.parent_path() / name)) << name;
  const auto read = rig::ReadRigCalibration(out);
  ASSERT_TRUE(read) << read.error().text;
  EXPECT_FALSE(read->target_placed);
  EXPECT_EQ(read->devices.camera.serial, "MOCK-CAMERA-1");
  EXPECT_EQ(read->devices.lens, "50 mm, f/8");
  EXPECT_EQ(read->radiometry.white, 255.0);
  const auto& known = read->covariances;
  ASSERT_TRUE(known.X_WC && known.X_WA && known.angle_scale && known.joint);
  EXPECT_EQ(known.X_WA->norm(), 0.0);
  EXPECT_NEAR(read->geometry.angle_scale, kScale, 4.0 * std::sqrt((*known.angle_scale)(0, 0)));
  // The true axis in C is W's z axis.
  const Eigen::Vector3d axis = (calib::LookAtOrigin(0.0, DegToRad(50.0), 420.0).Inverse() *
                                calib::Turn(Eigen::Vector3d::UnitX(), DegToRad(kTiltDeg)))
                                   .rotation.col(2);
  const Eigen::Vector3d found = read->geometry.X_WC.Inverse().rotation.col(2);
  EXPECT_LT(RadToDeg(std::acos(std::min(1.0, axis.dot(found)))), 0.05);
}

TEST_F(CalibrateAxisCommand, TheSameBitsForAnyNumberOfThreads) {
  ASSERT_EQ(Calibrate(*folder_ / "one/c.json", {"--threads", "1"}).exit_code, 0);
  ASSERT_EQ(Calibrate(*folder_ / "two/c.json", {"--threads", "2"}).exit_code, 0);
  EXPECT_EQ(ReadText(*folder_ / "one/c.json"), ReadText(*folder_ / "two/c.json"));
}

TEST_F(CalibrateAxisCommand, KeepsTheRadiometryThatIsThere) {
  const std::string out = *folder_ / "kept.json";
  ASSERT_EQ(Calibrate(out).exit_code, 0);
  auto calibration = rig::ReadRigCalibration(out);
  ASSERT_TRUE(calibration);
  calibration->radiometry.black = 3.0;
  calibration->noise.read_noise_dn = 1.25;
  calibration->target_placed = true;
  ASSERT_TRUE(rig::WriteRigCalibration(*calibration, out));
  ASSERT_EQ(Calibrate(out).exit_code, 0);
  const auto again = rig::ReadRigCalibration(out);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->radiometry.black, 3.0);
  EXPECT_EQ(again->noise.read_noise_dn, 1.25);
  EXPECT_FALSE(again->target_placed);
  // Of other devices it is not written over.
  calibration->devices.camera.serial = "another";
  ASSERT_TRUE(rig::WriteRigCalibration(*calibration, out));
  const Outcome refused = Calibrate(out);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("identity/camera/serial: \"another\""));
}

TEST_F(CalibrateAxisCommand, ARigWhoseTargetHasNoPlaceDoesNotCapture) {
  ASSERT_EQ(Calibrate(*folder_ / "unplaced.json").exit_code, 0);
  const std::string main =
      ReadText(std::string(TURNLIGHT_SOURCE_DIR) + "/configs/simulated_turntable.yaml");
  std::string config = kBoardRig + main.substr(main.find("\ngraph:"));
  Replace(config, "rig:\n", "rig:\n  calibration: unplaced.json\n");
  WriteText(*folder_ / "unplaced.yaml", config);
  for (const std::string command : {"capture", "plan"}) {
    std::vector<std::string> line{command, *folder_ / "unplaced.yaml"};
    if (command == "capture") line.insert(line.end(), {"--out", *folder_ / "unplaced"});
    const Outcome outcome = RunProgram(line);
    EXPECT_EQ(outcome.exit_code, 2) << command;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("X_AT"), HasSubstr("turnlight calibrate target")));
  }
}

TEST_F(CalibrateAxisCommand, WhatDoesNotFitTogetherIsRefused) {
  const std::string out = *folder_ / "refused.json";
  EXPECT_THAT(Calibrate(out, {}, "7by6").err, HasSubstr("--board"));
  const Outcome other = Calibrate(out, {}, "5x4");
  EXPECT_EQ(other.exit_code, 2) << other.err;
  EXPECT_THAT(other.err, HasSubstr("13 of the 13 pictures show a board of 7 x 6 inner corners"));
  WriteText(*folder_ / "small.cameramodel",
            calib::CameraModel::Pinhole(240, 180, 450, 450, 120, 90).ToString());
  const Outcome small =
      RunProgram({"calibrate", "axis", *folder_ / "board", "--board", "7x6", "--square-mm", "12",
                  "--camera", *folder_ / "small.cameramodel", "--out", out});
  EXPECT_EQ(small.exit_code, 2);
  EXPECT_THAT(small.err, HasSubstr("240 x 180 pixels, allowed is one of the pictures', 480 x 360"));
  EXPECT_EQ(Calibrate(*folder_ / "board/inside.json").exit_code, 2);
  fs::create_directory(*folder_ / "tampered");
  fs::copy(*folder_ / "lens/camera.cameramodel", *folder_ / "tampered");
  WriteText(*folder_ / "tampered/intrinsics.json",
            R"({"format": "turnlight-intrinsics", "version": 1, "camera_model": {"sha256": "a"},)"
            R"( "intrinsics": {"covariance": null}})");
  const Outcome tampered =
      RunProgram({"calibrate", "axis", *folder_ / "board", "--board", "7x6", "--square-mm", "12",
                  "--camera", *folder_ / "tampered", "--out", out});
  EXPECT_EQ(tampered.exit_code, 2);
  EXPECT_THAT(tampered.err, HasSubstr("camera_model/sha256"));
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace turnlight::app
