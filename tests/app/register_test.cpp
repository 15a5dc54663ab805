// Proves of the program: rendered pictures of a board, taken from known places, become a session
// with those poses and a keyframe for each step of view change; JPEG becomes PNG of the same
// values; picked corners of a plane do likewise; what cannot be is refused with what is allowed,
// and a picture without a board is named. Does not prove: anything of real cameras.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <string>

#include "base/angles.h"
#include "base/format.h"
#include "calib/rig_geometry.h"
#include "rig/session/image_file.h"
#include "rig/session/jpeg_file.h"
#include "rig/session/session.h"
#include "rig/sim/board_picture.h"
#include "tests/app/program.h"
#include "tests/rig/session/jpeg_writer.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
using calib::calibrate::board::Board;
using calib::calibrate::board::BoardKind;
using testing::AllOf;
using testing::HasSubstr;

calib::CameraModel WalkCamera() {
  return calib::CameraModel::Pinhole(640, 480, 700.0, 700.0, 319.5, 239.5);
}

calib::Pose CameraAt(double azimuth_deg) {
  return calib::LookAtOrigin(DegToRad(azimuth_deg), DegToRad(50.0), 320.0);
}

class Register : public testing::Test {
 protected:
  void SetUp() override { WriteText(folder_ / "lens.cameramodel", WalkCamera().ToString()); }
  // A 9 x 6 board of 12 mm around W's origin.
  std::string TakeBoard(double azimuth_deg) {
    const Board board{BoardKind::kChessboard, 9, 6, 12.0, 0.0, ""};
    calib::Pose X_WB;
    X_WB.rotation = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
    X_WB.translation = {-48.0, 30.0, 0.0};
    rig::sim::BoardPictureOptions options;
    options.blur_sigma = 0.5;
    options.noise_sigma = 0.005;
    options.stream = static_cast<std::uint64_t>(azimuth_deg);
    const std::string file = folder_ / Format("walk%03.0f.png", azimuth_deg);
    const auto picture = rig::sim::RenderBoards(
        {{board, CameraAt(azimuth_deg).Inverse() * X_WB, 15.0}}, WalkCamera(), options);
    EXPECT_TRUE(rig::WriteImage(file, picture));
    return file;
  }
  Outcome RunRegister(std::vector<std::string> pictures, std::vector<std::string> more) {
    std::vector<std::string> words{"register"};
    words.insert(words.end(), pictures.begin(), pictures.end());
    for (const std::string& word :
         {std::string("--camera"), folder_ / "lens.cameramodel", std::string("--out"), out_})
      words.push_back(word);
    words.insert(words.end(), more.begin(), more.end());
    return RunProgram(words);
  }

  const TemporaryFolder folder_;
  const std::string out_ = folder_ / "session";
  const std::vector<std::string> board_{"--board", "9x6", "--square-mm", "12"};
};

TEST_F(Register, AWalkRoundABoardBecomesASession) {
  std::vector<std::string> pictures;
  for (const double azimuth : {200.0, 208.0, 216.0, 224.0, 232.0, 240.0, 248.0})
    pictures.push_back(TakeBoard(azimuth));
  ASSERT_TRUE(rig::WriteImage(folder_ / "nothing.png", cv::Mat1b(480, 640, 128)));
  pictures.push_back(folder_ / "nothing.png");
  std::vector<std::string> more = board_;
  for (const char* word : {"--sphere", "20", "--at", "5,-3,20"}) more.push_back(word);
  const Outcome run = RunRegister(pictures, more);
  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  EXPECT_THAT(run.out, AllOf(HasSubstr("8 pictures, 7 registered"), HasSubstr("nothing.png: "),
                             HasSubstr("is a session")));
  const auto session = rig::ReadSession(out_);
  ASSERT_TRUE(session) << session.error().text;
  // 8 degrees of azimuth are 6 from the ball's middle and a little lower: every second picture.
  ASSERT_EQ(session->frames.size(), 4u);
  for (std::size_t i = 0; i < session->frames.size(); ++i) {
    const rig::FrameRecord& frame = session->frames[i];
    const calib::Pose truth = CameraAt(200.0 + 16.0 * static_cast<double>(i));
    EXPECT_LT((frame.X_WC.translation - truth.translation).norm(), 0.5) << i;
    EXPECT_LT((frame.X_WC.rotation - truth.rotation).norm(), 2e-3) << i;
    EXPECT_EQ(frame.X_WT.translation, Eigen::Vector3d(5.0, -3.0, 20.0));
    EXPECT_EQ(ReadText(fs::path(out_) / frame.image), ReadText(pictures[2 * i]));
  }
  EXPECT_EQ(RunProgram({"verify", out_}).exit_code, 0);
}

// With the values that they have, as PNG.
TEST_F(Register, JpegPicturesBecomePngWithANote) {
  std::vector<std::string> pictures;
  for (const double azimuth : {200.0, 220.0}) {
    const std::string png = TakeBoard(azimuth);
    pictures.push_back(fs::path(png).replace_extension(".jpg"));
    cv::Mat colour;
    cv::cvtColor(*rig::ReadImage(png), colour, cv::COLOR_GRAY2RGB);
    WriteText(pictures.back(), rig::WriteJpeg(colour));
  }
  std::vector<std::string> more = board_;
  for (const char* word : {"--sphere", "20", "--step-deg", "5"}) more.push_back(word);
  const Outcome run = RunRegister(pictures, more);
  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  EXPECT_THAT(run.out, HasSubstr("note: JPEG has 8 bits, is compressed with loss and gamma"));
  const auto session = rig::ReadSession(out_);
  ASSERT_TRUE(session) << session.error().text;
  EXPECT_EQ(session->radiometry.encoding, calib::Encoding::kSrgb);
  ASSERT_EQ(session->frames.size(), 2u);
  EXPECT_EQ(session->frames[1].image, "frames/001.png");
  const auto jpeg =
      rig::DecodeJpeg(ReadText(pictures[1]), pictures[1], rig::JpegChannels::kAsStored);
  ASSERT_TRUE(jpeg) << jpeg.error().text;
  EXPECT_EQ(cv::norm(*rig::ReadImage(fs::path(out_) / session->frames[1].image), jpeg->image,
                     cv::NORM_INF),
            0.0);
  EXPECT_EQ(RunProgram({"verify", out_}).exit_code, 0);
  fs::remove_all(out_);
  pictures.front() = TakeBoard(200.0);
  const Outcome mixed = RunRegister(pictures, more);
  EXPECT_EQ(mixed.exit_code, 2);
  EXPECT_THAT(mixed.err, HasSubstr("1 of 2 keyframes are JPEG, allowed are all or none"));
}

TEST_F(Register, PickedCornersOfAPlaneDoAsWell) {
  std::string text = "size: [120, 80]\npictures:\n";
  for (const double azimuth : {250.0, 262.0, 280.0}) {
    const calib::Pose X_CW = CameraAt(azimuth).Inverse();
    std::vector<Eigen::Vector3d> p_C;
    for (const Eigen::Vector3d& p_W :
         {Eigen::Vector3d(-60, 40, 0), {60, 40, 0}, {60, -40, 0}, {-60, -40, 0}})
      p_C.push_back(X_CW * p_W);
    const std::string name = Format("corners%03.0f.png", azimuth);
    EXPECT_TRUE(rig::WriteImage(folder_ / name, cv::Mat1b(480, 640, 100)));
    text += "  - {image: " + name + ", corners: [";
    for (const Eigen::Vector2d& pixel : WalkCamera().Project(p_C))
      text += Format("[%.3f, %.3f], ", pixel.x(), pixel.y());
    text += "]}\n";
  }
  WriteText(folder_ / "corners.yaml", text);
  const Outcome run =
      RunRegister({}, {"--corners", folder_ / "corners.yaml", "--encoding", "srgb"});
  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  const auto session = rig::ReadSession(out_);
  ASSERT_TRUE(session) << session.error().text;
  ASSERT_EQ(session->frames.size(), 2u);
  EXPECT_LT((session->frames[1].X_WC.translation - CameraAt(280.0).translation).norm(), 0.05);
  EXPECT_EQ(session->radiometry.encoding, calib::Encoding::kSrgb);
  EXPECT_EQ(std::get<calib::PlaneShape>(session->target).width, 120.0);
}

TEST_F(Register, WhatCannotBeIsRefused) {
  const std::string picture = TakeBoard(200.0);
  const auto refused = [&](std::vector<std::string> pictures, std::vector<std::string> more,
                           const std::string& why) {
    const Outcome run = RunRegister(std::move(pictures), std::move(more));
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_THAT(run.err, HasSubstr(why));
    EXPECT_FALSE(fs::exists(out_));
  };
  refused({}, {"--sphere", "20"}, "no pictures, allowed are one or more with --board");
  refused({picture}, board_, "0 targets, allowed is one of --sphere, --plane and --mesh");
  refused({picture}, {"--board", "9x6", "--square-mm", "12", "--sphere", "20", "--encoding", "log"},
          "--encoding: log, allowed is linear, srgb or a gamma");
  refused({picture}, {"--board", "7x5", "--square-mm", "12", "--sphere", "20"},
          "is it --board 9x6?");
  refused({picture}, {"--corners", folder_ / "none.yaml", "--board", "9x6"}, "--corners: ");
  refused({}, {"--corners", folder_ / "none.yaml"}, "none.yaml");
}

}  // namespace
}  // namespace turnlight::app
