// Proves, with the real program and mock devices: a raw capture needs no calibration and no target,
// says what will move, goes on after an interruption and a damaged picture, keeps several kinds in
// one folder, asks a person where it is told to, and refuses other devices. Does not prove: real
// hardware.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>

#include "base/file.h"
#include "rig/session/raw_capture.h"
#include "tests/app/program.h"

namespace turnlight::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr char kRawRig[] =
    "capture: {step_deg: 60, count: 4, settle_ms: 0, retries: 1}\n"
    "rig:\n"
    "  table: {driver: mock, max_speed_deg_s: 1000, acceleration_deg_s2: 10000, home_speed_deg_s: "
    "1000}\n"
    "  camera: {driver: mock, readout_ms: 1}\n"
    "simulation:\n"
    "  motion: {kind: table, distance: 420, elevation_deg: 50}\n"
    "  camera: {size: [80, 60], focal_px: 130}\n"
    "  sensor: {bits: 8, noise_relative: 0.02}\n"
    "  table: {settle_ms: 0}\n"
    "  prop: {kind: board, board: {columns: 6, rows: 4, spacing: 20}}\n";

class CalibrateCapture : public testing::Test {
 protected:
  CalibrateCapture() { WriteText(rig_, kRawRig); }
  Outcome Capture(const std::vector<std::string>& more) const {
    std::vector<std::string> line{"calibrate", "capture", rig_, "--out", out_};
    line.insert(line.end(), more.begin(), more.end());
    return RunProgram(line);
  }
  rig::RawCapture Read() const {
    const auto capture = rig::ReadRawCapture(out_);
    EXPECT_TRUE(capture) << capture.error().text;
    return capture.value_or(rig::RawCapture{});
  }

  const TemporaryFolder folder_;
  const std::string rig_ = folder_ / "rig.yaml", out_ = folder_ / "capture";
};

TEST_F(CalibrateCapture, NeedsNothingButTheDevices) {
  const Outcome outcome = Capture({});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("will turn from 0 to 180 degrees"),
                                 HasSubstr("the table mock will home")));
  const rig::RawCapture capture = Read();
  ASSERT_EQ(capture.frames.size(), 4u);
  EXPECT_EQ(capture.radiometry.white, 255.0);
  EXPECT_EQ(capture.devices.camera.serial, "MOCK-CAMERA-1");
  EXPECT_EQ(*capture.frames[3].angle_deg, 180.0);
  EXPECT_NEAR(*capture.frames[3].angle_measured_deg, 180.0, 0.05);
  EXPECT_EQ(*capture.frames[3].kind, "board");
}

TEST_F(CalibrateCapture, GoesOnWithWhatIsMissing) {
  ASSERT_EQ(Capture({}).exit_code, 0);
  const std::string before = ReadText(out_ + "/capture.json");
  EXPECT_THAT(Capture({}).out, HasSubstr("4 pictures of kind board, 0 of them taken now"));
  EXPECT_EQ(ReadText(out_ + "/capture.json"), before);
  std::filesystem::remove(out_ + "/frames/board_001.png");
  WriteText(out_ + "/frames/board_002.png", "torn");
  const Outcome outcome = Capture({});
  EXPECT_THAT(outcome.out, HasSubstr("4 pictures of kind board, 2 of them taken now"));
  const rig::RawCapture capture = Read();
  for (std::size_t i = 0; i < 4; ++i) EXPECT_TRUE(rig::ReadRawImage(capture, i));
}

TEST_F(CalibrateCapture, KeepsSeveralKindsInOneFolder) {
  ASSERT_EQ(Capture({}).exit_code, 0);
  const Outcome flat = Capture(
      {"--kind", "flat", "--no-move", "--exposures", "1000,2000", "--pairs", "2", "--gain", "3"});
  EXPECT_EQ(flat.exit_code, 0) << flat.err;
  EXPECT_THAT(flat.err, AllOf(HasSubstr("nothing moves"), Not(HasSubstr("home"))));
  const rig::RawCapture capture = Read();
  const auto frames = rig::FramesOfKind(capture, "flat");
  ASSERT_EQ(frames.size(), 8u);
  EXPECT_EQ(capture.frames.size(), 12u);
  const rig::RawCaptureFrame& last = capture.frames[frames.back()];
  EXPECT_EQ(last.exposure.exposure_us, 2000.0);
  EXPECT_EQ(last.exposure.gain_db, 3.0);
  EXPECT_FALSE(last.angle_deg);
  EXPECT_NE(*last.sha256, *capture.frames[frames[6]].sha256);
  EXPECT_EQ(capture.devices.table.serial, "MOCK-TABLE-1");
}

TEST_F(CalibrateCapture, WhatIsRefused) {
  ASSERT_EQ(Capture({}).exit_code, 0);
  const Outcome other = Capture({"--exposures", "500"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("allowed is the same again, or another --out or --kind"));
  EXPECT_EQ(Capture({"--kind", "two words"}).exit_code, 2);
  EXPECT_EQ(Capture({"--exposures", "0"}).exit_code, 2);
  std::string text = kRawRig;
  Replace(text, "readout_ms: 1", "readout_ms: 1, serial: OTHER");
  WriteText(rig_, text);
  const Outcome foreign = Capture({});
  EXPECT_EQ(foreign.exit_code, 2);
  EXPECT_THAT(foreign.err, AllOf(HasSubstr("identity/camera"), HasSubstr("OTHER")));
  const Outcome asked = Capture({"--kind", "held", "--no-move", "--ask"});
  EXPECT_EQ(asked.exit_code, 2);  // of another camera, too
}

TEST_F(CalibrateCapture, SomebodyMustBeThereToBeAsked) {
  const Outcome outcome = Capture({"--no-move", "--count", "2", "--ask"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("picture 1 of 2: hold it still, then Enter"),
                                 HasSubstr("standard input has ended")));
}

TEST_F(CalibrateCapture, InterruptsHaltTheMotorAndLoseNothing) {
  std::string text = kRawRig;
  Replace(text, "max_speed_deg_s: 1000", "max_speed_deg_s: 60");
  WriteText(rig_, text);
  const std::string err = folder_ / "err";
  const pid_t process = Start({"calibrate", "capture", rig_, "--out", out_}, err);
  while (Lines(out_ + "/capture.json") == 0) ::usleep(2000);
  ::kill(process, SIGINT);
  EXPECT_EQ(Finish(process), 130);
  EXPECT_THAT(ReadText(err), HasSubstr("the same command goes on"));
  EXPECT_LT(Read().frames.size(), 4u);
  const Outcome rest = Capture({});
  EXPECT_EQ(rest.exit_code, 0) << rest.err;
  EXPECT_THAT(rest.err, HasSubstr("of them are there and good"));
  EXPECT_EQ(Read().frames.size(), 4u);
}

}  // namespace
}  // namespace turnlight::app
