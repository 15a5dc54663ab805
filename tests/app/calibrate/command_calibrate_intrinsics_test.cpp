// Proves: the program goes from pictures of a board to a lens near the true one, whose file, JSON
// and report are there; pictures that are no use are named with the reason; and it refuses what it
// cannot use in words that name it.
// Does not prove: how exact corners are, nor the fit (calib/calibrate/board, calib/calibrate/lens).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "calib/camera_model.h"
#include "rig/session/image_file.h"
#include "rig/sim/board_picture.h"
#include "tests/app/program.h"
#include "tests/temporary_folder.h"

namespace turnlight::app {
namespace {

using testing::HasSubstr;
namespace board = calib::calibrate::board;

const calib::CameraModel kLens = calib::CameraModel::Pinhole(640, 480, 620.0, 618.0, 325.0, 236.0);
const board::Board kBoard{board::BoardKind::kChessboard, 8, 6, 20.0, 0.0, ""};

cv::Mat PictureOf(const board::Board& what, double about_x, double about_y, double x, double y,
                  double distance) {
  calib::Pose X_CB;
  X_CB.rotation = (Eigen::AngleAxisd(about_x, Eigen::Vector3d::UnitX()) *
                   Eigen::AngleAxisd(about_y, Eigen::Vector3d::UnitY()))
                      .toRotationMatrix();
  const Eigen::Vector3d middle(0.5 * what.spacing * (what.columns - 1),
                               0.5 * what.spacing * (what.rows - 1), 0.0);
  X_CB.translation = Eigen::Vector3d(x, y, distance) - X_CB.rotation * middle;
  rig::sim::BoardPictureOptions options;
  options.blur_sigma = 0.6;
  options.samples = 3;
  return rig::sim::RenderBoards({{what, X_CB, 10.0}}, kLens, options);
}

// Eight pictures of the board, all over the sensor.
void WriteBoardPictures(const TemporaryFolder& folder) {
  const double tilts[8][2] = {{0.5, 0.0},  {-0.5, 0.1}, {0.1, 0.5},   {0.0, -0.5},
                              {0.4, -0.4}, {-0.4, 0.3}, {0.35, 0.35}, {-0.3, -0.4}};
  for (int i = 0; i < 8; ++i) {
    const cv::Mat picture = PictureOf(kBoard, tilts[i][0], tilts[i][1], (i % 3 - 1) * 55.0,
                                      (i % 2 == 0 ? 1 : -1) * 35.0, 330.0 + 10.0 * i);
    ASSERT_TRUE(rig::WriteImage(folder / ("board" + std::to_string(i) + ".png"), picture));
  }
}

std::vector<std::string> Line(const std::string& pictures, const std::string& out) {
  return {"calibrate", "intrinsics", pictures,  "--board", "8x6", "--square-mm",
          "20",        "--lens",     "OPENCV4", "--out",   out};
}

TEST(CalibrateIntrinsics, FromPicturesToALens) {
  const TemporaryFolder folder, out;
  WriteBoardPictures(folder);
  ASSERT_TRUE(rig::WriteImage(folder / "wall.png", cv::Mat(480, 640, CV_8U, cv::Scalar(90))));
  auto line = Line(folder.path().string(), out / "lens");
  line.insert(line.end(), {"--distance-mm", "400"});
  const Outcome outcome = RunProgram(line);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("8 views of 9 pictures used"));
  EXPECT_THAT(outcome.out, HasSubstr("wall.png: no board found"));
  EXPECT_THAT(outcome.out, HasSubstr("Good for"));
  EXPECT_THAT(outcome.err, HasSubstr("finding the board"));
  const auto camera = calib::CameraModel::FromFile(out / "lens/camera.cameramodel");
  ASSERT_TRUE(camera) << camera.error().text;
  EXPECT_NEAR(camera->intrinsics()[0], 620.0, 3.0);
  const auto json = nlohmann::json::parse(ReadText(out / "lens/intrinsics.json"));
  EXPECT_LT(json.at("rms_px"), 0.1);
  EXPECT_EQ(json.at("images").at("dropped").size(), 1u);
  for (const char* name : {"residuals", "views", "histogram", "coverage", "uncertainty",
                           "uncertainty_at_distance", "halves"})
    EXPECT_FALSE(ReadText(out / ("lens/" + std::string(name) + ".png")).empty()) << name;
}

TEST(CalibrateIntrinsics, TheNumberOfThreadsChangesNothing) {
  const TemporaryFolder folder, out;
  WriteBoardPictures(folder);
  for (const char* threads : {"1", "3"}) {
    auto line = Line(folder.path().string(), out / threads);
    line.insert(line.end(), {"--threads", threads});
    ASSERT_EQ(RunProgram(line).exit_code, 0);
  }
  EXPECT_EQ(ReadText(out / "1/intrinsics.json"), ReadText(out / "3/intrinsics.json"));
}

TEST(CalibrateIntrinsics, RefusesInWords) {
  const TemporaryFolder folder, out;
  WriteBoardPictures(folder);
  const auto refusal = [&](const std::vector<std::string>& line) {
    const Outcome outcome = RunProgram(line);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    return outcome.err;
  };
  EXPECT_THAT(refusal(Line(folder / "board0.png", out / "lens")),
              testing::AllOf(HasSubstr("one view of the board"), HasSubstr("board0.png")));
  auto line = Line(folder.path().string(), out / "lens");
  line[8] = "FISHEYE";
  EXPECT_THAT(refusal(line), HasSubstr("--lens: 'FISHEYE' is no lens model; allowed are"));
  const TemporaryFolder walls;
  for (const char* name : {"a.png", "b.png"})
    ASSERT_TRUE(rig::WriteImage(walls / name, cv::Mat(480, 640, CV_8U, cv::Scalar(90))));
  EXPECT_THAT(refusal(Line(walls.path().string(), out / "lens")),
              HasSubstr("none of the 2 pictures shows the board"));
  line = Line(folder.path().string(), out / "lens");
  line[4] = "5x4";
  const Outcome another = RunProgram(line);
  EXPECT_NE(another.exit_code, 0);
  EXPECT_THAT(another.err, HasSubstr("show a board of 8 x 6 inner corners instead"));
  EXPECT_THAT(refusal(Line(folder / "missing.png", out / "lens")), HasSubstr("missing.png"));
  ASSERT_TRUE(rig::WriteImage(folder / "other.png", cv::Mat(300, 400, CV_8U, cv::Scalar(90))));
  EXPECT_THAT(refusal(Line(folder.path().string(), out / "lens")),
              HasSubstr("other.png (400 x 300): other sizes than the 8 pictures of 640 x 480"));
}

}  // namespace
}  // namespace turnlight::app
