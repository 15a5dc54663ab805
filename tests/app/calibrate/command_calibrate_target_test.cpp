// Proves, by the program itself: a session of rendered pictures and a calibration without X_AT give
// one with it, right and readable, with masks, report and pictures; what does not fit together is
// refused by name. How right X_AT is, is placement_test's.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "base/file.h"
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
using testing::HasSubstr;

// A ball in the middle of a table that turns, six pictures, no masks; and the rig's calibration, as
// the axis's command would have left it.
struct Scene {
  TemporaryFolder folder;
  std::string session = (folder.path() / "session").string();
  std::string calibration = (folder.path() / "axis" / "rig-calibration.json").string();
  std::string out = (folder.path() / "target").string();

  Scene() {
    WriteSession(BallOnTableConfig(6), session);
    WriteCalibration("mm");
  }

  void WriteCalibration(const std::string& unit) {
    const auto taken = rig::ReadSession(session);
    rig::RigCalibration rig(*taken->camera);
    rig.length_unit = unit;
    rig.geometry.X_WC = taken->frames[0].X_WC;
    rig.target_placed = false;
    rig.devices.resolution = {320, 240};
    rig.covariances.X_WC = 1e-6 * Eigen::MatrixXd::Identity(6, 6);
    EXPECT_TRUE(MakeDirectory(fs::path(calibration).parent_path()));
    EXPECT_TRUE(rig::WriteRigCalibration(rig, calibration));
  }

  Outcome Run(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"calibrate", "target", session, "--calibration",
                                       calibration, "--out",  out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(arguments);
  }
};

TEST(CalibrateTarget, PlacesABallAndWritesAllOfIt) {
  const Scene scene;
  const Outcome outcome = scene.Run();
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("target at ("));
  const fs::path out = scene.out;
  const auto placed = rig::ReadRigCalibration(out / "rig-calibration.json");
  ASSERT_TRUE(placed) << placed.error().text;
  EXPECT_TRUE(placed->target_placed);
  EXPECT_LT(placed->geometry.X_AT.translation.norm(), 0.1);
  ASSERT_TRUE(placed->covariances.X_AT && placed->covariances.joint);
  for (int i = 3; i < 6; ++i)
    EXPECT_LT(std::abs(placed->geometry.X_AT.translation[i - 3]),
              4.0 * std::sqrt((*placed->covariances.X_AT)(i, i)));
  for (const char* name : {"placement.png", "residuals.png", "masks/000.png", "masks/005.png"})
    EXPECT_TRUE(rig::ReadImage(out / name)) << name;
  EXPECT_THAT(ReadText(out / "placement.json"), HasSubstr("\"turnlight-placement\""));
  // The same bits for any number of threads, and into a folder where it has been before.
  const std::string before = ReadText(out / "placement.json");
  ASSERT_EQ(scene.Run({"--threads", "1"}).exit_code, 0);
  EXPECT_EQ(ReadText(out / "placement.json"), before);
}

TEST(CalibrateTarget, RefusesWhatDoesNotFitTogether) {
  Scene scene;
  scene.WriteCalibration("m");
  EXPECT_THAT(scene.Run().err, HasSubstr("length_unit: \"m\", allowed is the session's, \"mm\""));
  scene.WriteCalibration("mm");
  const Outcome two = scene.Run({"--empty", "a.png", "--empty", "b.png"});
  EXPECT_EQ(two.exit_code, 2);
  EXPECT_THAT(two.err, HasSubstr("--empty: 2 pictures, allowed are one, or one for each of the 6"));
  const Outcome inside = RunProgram({"calibrate", "target", scene.session, "--calibration",
                                     scene.calibration, "--out", scene.session + "/target"});
  EXPECT_EQ(inside.exit_code, 2);
  EXPECT_THAT(inside.err, HasSubstr("lies within it"));
  const fs::path points = scene.folder.path() / "points.csv";
  WriteText(points, "9 1 2 3 4 5\n");
  EXPECT_THAT(scene.Run({"--points", points.string()}).err,
              HasSubstr("points.csv:1: frame 9, allowed is a whole number from 0 to 5"));
}

TEST(CalibrateTarget, SaysWhichFrameHasNoAngle) {
  const Scene scene;
  std::string text = ReadText(fs::path(scene.session) / "session.json");
  const auto at = text.find("\"angle_deg\":");
  ASSERT_NE(at, std::string::npos);
  text.erase(at, text.find(',', at) - at + 1);
  WriteText(fs::path(scene.session) / "session.json", text);
  const Outcome outcome = scene.Run();
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("frames/0/angle_deg: missing"));
}

// The same ball in a raw capture, which knows neither poses nor target; the empty table is in it.
TEST(CalibrateTarget, OfARawCapture) {
  const Scene scene;
  const fs::path raw = scene.folder.path() / "raw";
  const auto session = rig::ReadSession(scene.session);
  ASSERT_TRUE(session);
  rig::RawCapture capture;
  capture.name = "raw";
  capture.radiometry = session->radiometry;
  capture.devices.resolution = {320, 240};
  ASSERT_TRUE(MakeDirectory(raw));
  const auto add = [&](const cv::Mat& picture, const std::string& name, const std::string& kind,
                       std::optional<double> angle_deg) {
    ASSERT_TRUE(rig::WriteImage(raw / name, picture));
    rig::RawCaptureFrame frame;
    frame.image = name;
    frame.kind = kind;
    frame.angle_deg = angle_deg;
    frame.exposure.exposure_us = 1000.0;
    capture.frames.push_back(frame);
  };
  for (std::size_t i = 0; i < session->frames.size(); ++i) {
    const auto images = rig::ReadFrameImages(*session, i);
    ASSERT_TRUE(images);
    if (i == 0)
      add(cv::Mat::zeros(images->image.size(), images->image.type()), "empty.png", "empty", {});
    add(images->image, "target" + std::to_string(i) + ".png", "target",
        session->frames[i].angle_deg);
  }
  ASSERT_TRUE(rig::WriteRawCapture(capture, raw));
  const std::vector<std::string> line{"calibrate",       "target", raw.string(), "--calibration",
                                      scene.calibration, "--out",  scene.out};
  EXPECT_THAT(RunProgram(line).err,
              HasSubstr("0 targets, allowed is one of --sphere, --plane and --mesh"));
  std::vector<std::string> with = line;
  with.insert(with.end(), {"--sphere", "40"});
  const Outcome outcome = RunProgram(with);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto found = rig::ReadRigCalibration(scene.out + "/rig-calibration.json");
  ASSERT_TRUE(found) << found.error().text;
  EXPECT_LT(found->geometry.X_AT.translation.norm(), 0.1);
  EXPECT_THAT(scene.Run({"--sphere", "40"}).err, HasSubstr("says itself what its target is"));
}

}  // namespace
}  // namespace turnlight::app
