// Proves: a session's copy of the rig's calibration is read if it is the session's, and refused,
// naming what differs, if it was changed, is of another lens, or its poses are not the frames'.
// Sessions without one are as they were. Does not prove that a calibration is true.
#include "rig/session_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/file.h"
#include "base/sha256.h"
#include "rig/session/image_file.h"
#include "tests/temporary_folder.h"

namespace turnlight::rig {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class SessionCalibration : public testing::Test {
 protected:
  SessionCalibration() : calibration_(calib::CameraModel::Pinhole(16, 12, 20, 20, 8, 6)) {
    calibration_.geometry.X_WC = calib::LookAtOrigin(0.3, 0.5, 400.0);
    calibration_.geometry.X_AT.translation = {10, 5, 3};
    calibration_.geometry.angle_scale = 1.001;
    calibration_.devices.resolution = {16, 12};
    session_.name = "s";
    session_.length_unit = "mm";
    session_.camera_path = "camera.cameramodel";
    session_.camera = calibration_.lens;
    session_.target = calib::SphereShape{50.0};
    session_.root = folder_.path();
    EXPECT_TRUE(MakeDirectory(folder_ / "frames"));
    for (const double angle_deg : {0.0, 120.04}) {
      FrameRecord frame;
      frame.image = "frames/" + std::to_string(session_.frames.size()) + ".png";
      EXPECT_TRUE(WriteImage(folder_ / frame.image, cv::Mat1w(12, 16, std::uint16_t{900})));
      frame.angle_deg = std::round(angle_deg);
      frame.angle_measured_deg = angle_deg;
      const auto poses = calib::PosesAt(calibration_.geometry, angle_deg);
      frame.X_WC = poses.X_WC;
      frame.X_WT = poses.X_WT;
      session_.frames.push_back(frame);
    }
  }

  // Writes it with this calibration, and reads all of it back.
  Result<std::optional<RigCalibration>> Read(const RigCalibration& calibration) {
    const std::string text = PrintRigCalibration(calibration, "lens.cameramodel");
    EXPECT_TRUE(WriteFileAtomic(folder_ / "lens.cameramodel", calibration.lens.ToString()));
    EXPECT_TRUE(WriteFileAtomic(folder_ / "rig-calibration.json", text));
    session_.calibration = {"rig-calibration.json", Sha256Hex(text)};
    return ReadAgain();
  }
  Result<std::optional<RigCalibration>> ReadAgain() {
    EXPECT_TRUE(WriteSession(session_, folder_.path()));
    const auto session = ReadSession(folder_.path());
    if (!session) return Forward(session);
    return ReadSessionCalibration(*session);
  }

  TemporaryFolder folder_;
  RigCalibration calibration_;
  Session session_;
};

TEST_F(SessionCalibration, IsReadAndCountsForTheContent) {
  const auto none = ReadAgain();
  ASSERT_TRUE(none) << none.error().text;
  EXPECT_FALSE(*none);
  EXPECT_THAT(*ReadFile(folder_ / "session.json"), testing::Not(HasSubstr("calibration")));
  const auto without = VerifySession(folder_.path());
  const auto read = Read(calibration_);
  ASSERT_TRUE(read) << read.error().text;
  ASSERT_TRUE(*read);
  EXPECT_EQ((*read)->geometry.angle_scale, 1.001);
  const auto with = VerifySession(folder_.path());
  ASSERT_TRUE(with && without);
  EXPECT_TRUE(with->problems.empty()) << with->problems.front();
  EXPECT_NE(with->content_sha256, without->content_sha256);
}

TEST_F(SessionCalibration, ThatWasChangedIsRefused) {
  ASSERT_TRUE(Read(calibration_));
  const std::string file = folder_ / "rig-calibration.json";
  ASSERT_TRUE(WriteFileAtomic(file, *ReadFile(file) + " "));
  const auto changed = ReadAgain();
  ASSERT_FALSE(changed);
  EXPECT_THAT(changed.error().text, AllOf(HasSubstr(file + ": the file changed: its SHA-256 is"),
                                          HasSubstr("calibration/sha256 of session.json")));
  const auto report = VerifySession(folder_.path());
  ASSERT_TRUE(report);
  EXPECT_THAT(report->problems, testing::ElementsAre(HasSubstr("the file changed")));
  session_.calibration->sha256 = "abc";
  EXPECT_FALSE(WriteSession(session_, folder_.path()));
  session_.calibration = {"../rig-calibration.json", std::string(64, 'a')};
  EXPECT_THAT(WriteSession(session_, folder_.path()).error().text, HasSubstr("calibration/path"));
}

TEST_F(SessionCalibration, OfAnotherRigIsRefusedNamingWhatDiffers) {
  RigCalibration other = calibration_;
  other.lens = calib::CameraModel::Pinhole(16, 12, 20, 21, 8, 6);
  EXPECT_THAT(Read(other).error().text,
              HasSubstr("camera_model: its intrinsic 1 is 21, that of the session's camera is 20"));
  other.lens = calib::CameraModel::Pinhole(16, 10, 20, 20, 8, 6);
  other.devices.resolution = {16, 10};
  EXPECT_THAT(Read(other).error().text, HasSubstr("its resolution is 16 x 10"));
  other = calibration_;
  other.length_unit = "m";
  EXPECT_THAT(Read(other).error().text, HasSubstr("length_unit: m, allowed is the session's, mm"));
  other = calibration_;
  other.target_placed = false;
  EXPECT_THAT(Read(other).error().text, HasSubstr("turnlight calibrate target"));
}

TEST_F(SessionCalibration, PosesAreThoseOfTheCalibration) {
  RigCalibration other = calibration_;
  other.geometry.angle_scale = 1.0;
  EXPECT_THAT(Read(other).error().text, AllOf(HasSubstr("session.json: frames/1/X_WT: differs by"),
                                              HasSubstr("from the pose at 120.04 deg")));
  other = calibration_;
  other.geometry.X_WC.translation.x() += 1e-3;
  EXPECT_THAT(Read(other).error().text, HasSubstr("frames/0/X_WC: differs by"));
  other.geometry.X_WC.translation.x() -= 1e-3 - 1e-9;
  EXPECT_TRUE(Read(other)) << "rounding";
  session_.frames[1].angle_deg.reset();
  session_.frames[1].angle_measured_deg.reset();
  EXPECT_THAT(Read(calibration_).error().text,
              HasSubstr("frames/1/angle_deg: this key is missing"));
}

}  // namespace
}  // namespace turnlight::rig
