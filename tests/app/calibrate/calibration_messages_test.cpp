// Proves: what the program says to pictures that are no good for a calibration: mixed boards, a
// wrong --board, blur, overexposure, a mirrored print, pictures of another camera; and that 200
// pictures are no matter. Does not prove where the limits are (calib/calibrate/board and lens).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calib/camera_model.h"
#include "rig/session/image_file.h"
#include "rig/sim/board_picture.h"
#include "tests/app/program.h"
#include "tests/temporary_folder.h"

namespace turnlight::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;
namespace board = calib::calibrate::board;

const board::Board kNineBySix{board::BoardKind::kChessboard, 9, 6, 20.0, 0.0, ""};
const board::Board kSeven{board::BoardKind::kChessboard, 7, 7, 20.0, 0.0, ""};

// View number i of the board, with the board tilted and moved from view to view.
cv::Mat ViewOf(const board::Board& what, int i, rig::sim::BoardPictureOptions options = {}) {
  const auto camera = calib::CameraModel::Pinhole(480, 360, 465.0, 464.0, 243.0, 177.0);
  calib::Pose X_CB;
  X_CB.rotation = (Eigen::AngleAxisd(0.5 * std::sin(2.0 * i), Eigen::Vector3d::UnitX()) *
                   Eigen::AngleAxisd(0.5 * std::cos(3.1 * i), Eigen::Vector3d::UnitY()))
                      .toRotationMatrix();
  const Eigen::Vector3d middle(0.5 * what.spacing * (what.columns - 1),
                               0.5 * what.spacing * (what.rows - 1), 0.0);
  X_CB.translation =
      Eigen::Vector3d(40.0 * std::sin(1.3 * i), 25.0 * std::cos(1.7 * i), 340.0 + 10.0 * (i % 8)) -
      X_CB.rotation * middle;
  options.samples = 3;
  if (options.blur_sigma == 0.0) options.blur_sigma = 0.6;
  return rig::sim::RenderBoards({{what, X_CB, 10.0}}, camera, options);
}

void WriteViews(const TemporaryFolder& folder, const std::string& name, const board::Board& what,
                int count, const rig::sim::BoardPictureOptions& options = {}) {
  for (int i = 0; i < count; ++i)
    ASSERT_TRUE(
        rig::WriteImage(folder / (name + std::to_string(i) + ".png"), ViewOf(what, i, options)));
}

Outcome Calibrate(const TemporaryFolder& pictures, const std::string& size,
                  const std::vector<std::string>& more = {}) {
  const TemporaryFolder out;
  std::vector<std::string> line{"calibrate", "intrinsics", pictures.path().string(),
                                "--board",   size,         "--square-mm",
                                "20",        "--lens",     "OPENCV4",
                                "--out",     out / "lens"};
  line.insert(line.end(), more.begin(), more.end());
  return RunProgram(line);
}

TEST(CalibrationMessages, AWrongBoardIsToldTheSizeThatIsSeen) {
  const TemporaryFolder folder;
  WriteViews(folder, "view", kNineBySix, 6);
  for (const char* size : {"8x6", "8x5", "10x7", "7x7", "6x6"}) {
    const Outcome outcome = Calibrate(folder, size);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("--board " + std::string(size)),
                                   HasSubstr("6 of the 6 pictures show a board of 9 x 6"),
                                   HasSubstr("view0.png"), HasSubstr("is it --board 9x6?")));
  }
}

TEST(CalibrationMessages, MixedBoardsAreToldApart) {
  const TemporaryFolder folder;
  WriteViews(folder, "nine", kNineBySix, 8);
  WriteViews(folder, "seven", kSeven, 2);
  const Outcome outcome = Calibrate(folder, "9x6");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("8 views of 10 pictures used"),
                                 HasSubstr("seven0.png: the picture shows 7 x 7 inner corners, "
                                           "the board is said to have 9 x 6"),
                                 HasSubstr("seven1.png: the picture shows 7 x 7")));
}

TEST(CalibrationMessages, BlurAndOverexposureAreToldByPicture) {
  const TemporaryFolder folder;
  WriteViews(folder, "view", kNineBySix, 8);
  rig::sim::BoardPictureOptions poor;
  poor.blur_sigma = 3.0;
  ASSERT_TRUE(rig::WriteImage(folder / "soft.png", ViewOf(kNineBySix, 8, poor)));
  poor.blur_sigma = 0.6;
  poor.bright = 2.0;
  ASSERT_TRUE(rig::WriteImage(folder / "bright.png", ViewOf(kNineBySix, 9, poor)));
  ASSERT_TRUE(rig::WriteImage(folder / "white.png", cv::Mat(360, 480, CV_8U, cv::Scalar(255))));
  const Outcome outcome = Calibrate(folder, "9x6");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("soft.png: blurred: edges are"),
                                 HasSubstr("bright.png: overexposed:"),
                                 HasSubstr("white.png: no board found: overexposed")));
}

TEST(CalibrationMessages, AMirroredPrintIsToldWhereItCanBe) {
  const board::Board charuco{board::BoardKind::kCharuco, 7, 5, 20.0, 14.5, "4X4_50"};
  const TemporaryFolder folder;
  for (int i = 0; i < 2; ++i) {
    cv::Mat picture = ViewOf(charuco, i);
    cv::flip(picture, picture, 1);
    ASSERT_TRUE(rig::WriteImage(folder / ("m" + std::to_string(i) + ".png"), picture));
  }
  const Outcome outcome = Calibrate(folder, "7x5", {"--charuco", "4X4_50", "--marker-mm", "14.5"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("printed mirrored"), HasSubstr("m0.png")));
}

TEST(CalibrationMessages, PicturesOfAnotherCameraAreNamed) {
  const TemporaryFolder folder;
  WriteViews(folder, "view", kNineBySix, 4);
  cv::Mat other;
  cv::resize(ViewOf(kNineBySix, 4), other, {400, 300});
  ASSERT_TRUE(rig::WriteImage(folder / "phone.png", other));
  const Outcome outcome = Calibrate(folder, "9x6");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("phone.png (400 x 300): other sizes than the 4 "
                                           "pictures of 480 x 360")));
}

TEST(CalibrationMessages, TwoHundredPicturesAreFitted) {
  const TemporaryFolder folder;
  std::vector<cv::Mat> views;
  for (int i = 0; i < 20; ++i) views.push_back(ViewOf(kNineBySix, i));
  for (int i = 0; i < 200; ++i) {
    cv::Mat noisy;
    cv::Mat noise(views[0].size(), CV_16S);
    cv::RNG(static_cast<std::uint64_t>(i) + 1).fill(noise, cv::RNG::NORMAL, 0.0, 2.0);
    cv::add(views[static_cast<std::size_t>(i % 20)], noise, noisy, cv::noArray(), CV_8U);
    ASSERT_TRUE(rig::WriteImage(folder / (std::to_string(i) + ".png"), noisy));
  }
  const Outcome outcome = Calibrate(folder, "9x6");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("200 views of 200 pictures used"));
}

}  // namespace
}  // namespace turnlight::app
