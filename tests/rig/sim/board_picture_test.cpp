// Proves: rendered boards lie where the camera model projects them, to 0.005 pixels of an edge's
// place; levels, noise and hiding are as asked. Does not prove that a detector finds them
// (tests/calib/calibrate/board/detect_boards_test.cpp does).
#include "rig/sim/board_picture.h"

#include <gtest/gtest.h>

#include <numbers>

#include "calib/calibrate/board/board_print.h"

namespace turnlight::rig::sim {
namespace {

using calib::calibrate::board::Board;
using calib::calibrate::board::BoardKind;

calib::Pose At(double x, double y, double z, double turn = 0.0) {
  calib::Pose pose;
  pose.rotation = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()).toRotationMatrix();
  pose.translation = {x, y, z};
  return pose;
}

calib::CameraModel Camera() {
  return calib::CameraModel::Pinhole(640, 480, 600, 600, 319.5, 239.5);
}

// Where a row of pixels changes from the first level to the last, from the sum of its levels.
double EdgeFrom(const cv::Mat& picture, int row, int begin, int end) {
  const double first = picture.at<std::uint16_t>(row, begin);
  const double last = picture.at<std::uint16_t>(row, end - 1);
  double sum = 0.0;
  for (int u = begin; u < end; ++u) sum += picture.at<std::uint16_t>(row, u) - last;
  return begin - 0.5 + sum / (first - last);
}

TEST(BoardPicture, EdgesLieWhereTheCameraProjectsThem) {
  const PlacedBoard placed{
      {BoardKind::kChessboard, 4, 3, 30.0, 0.0, ""}, At(-45, -30, 400, 0.4), 0};
  BoardPictureOptions options;
  options.samples = 16;
  options.depth = CV_16U;
  const auto camera = Camera();
  const cv::Mat picture = RenderBoards({placed}, camera, options);
  const auto pixels = BoardPixels(placed, camera);
  // Between rows 0 and 1 of the board the edge through points 1 and 5 is upright, as the turn is
  // about y.
  const auto middle = (pixels[1] + pixels[5]) / 2.0;
  const int u = static_cast<int>(std::round(middle.x()));
  EXPECT_NEAR(EdgeFrom(picture, static_cast<int>(std::round(middle.y())), u - 8, u + 9), middle.x(),
              0.005);
}

TEST(BoardPicture, LevelsAreAsAsked) {
  const PlacedBoard placed{{BoardKind::kChessboard, 4, 3, 30.0, 0.0, ""}, At(-45, -30, 400), 15};
  const cv::Mat picture = RenderBoards({placed}, Camera());
  const auto level = [&](double x, double y) {
    const auto p = Camera().Project({placed.X_CB * Eigen::Vector3d(x, y, 0)})[0];
    return picture.at<unsigned char>(static_cast<int>(std::round(p.y())),
                                     static_cast<int>(std::round(p.x())));
  };
  EXPECT_EQ(level(-15, -15), 13);   // before point 0: dark
  EXPECT_EQ(level(15, -15), 204);   // its neighbour: bright
  EXPECT_EQ(level(-37, -37), 204);  // the border
  EXPECT_EQ(picture.at<unsigned char>(2, 2), 102);
}

TEST(BoardPicture, ALaterBoardHidesAnEarlierOneAndItsBackIsBlank) {
  const Board board{BoardKind::kChessboard, 4, 3, 30.0, 0.0, ""};
  PlacedBoard back{board, At(45, -30, 300, std::numbers::pi), 0};
  const cv::Mat picture = RenderBoards({{board, At(-45, -30, 400), 0}, back}, Camera());
  EXPECT_EQ(picture.at<unsigned char>(240, 320), 204);
  EXPECT_EQ(picture.at<unsigned char>(200, 280), 204);
}

TEST(BoardPicture, NoiseIsAsWideAsAskedAndRepeats) {
  BoardPictureOptions options;
  options.noise_sigma = 0.02;
  options.depth = CV_16U;
  const cv::Mat picture = RenderBoards({}, Camera(), options);
  cv::Scalar mean, sigma;
  cv::meanStdDev(picture, mean, sigma);
  EXPECT_NEAR(mean[0] / 65535.0, 0.4, 2e-4);
  EXPECT_NEAR(sigma[0] / 65535.0, 0.02, 2e-4);
  EXPECT_EQ(cv::norm(picture, RenderBoards({}, Camera(), options), cv::NORM_INF), 0.0);
  options.stream = 1;
  EXPECT_GT(cv::norm(picture, RenderBoards({}, Camera(), options), cv::NORM_INF), 0.0);
}

TEST(BoardPicture, AStrongLensIsFollowed) {
  const auto camera = calib::CameraModel::FromString(
      "{'lensmodel': 'LENSMODEL_OPENCV4', 'intrinsics': [500, 500, 319.5, 239.5, -0.25, 0.05, "
      "0.001, "
      "-0.001], 'extrinsics': [0, 0, 0, 0, 0, 0], 'imagersize': [640, 480]}",
      "test");
  ASSERT_TRUE(camera) << camera.error().text;
  const PlacedBoard placed{{BoardKind::kChessboard, 9, 6, 30.0, 0.0, ""}, At(-120, -75, 300), 0};
  BoardPictureOptions options;
  options.samples = 16;
  options.depth = CV_16U;
  const cv::Mat picture = RenderBoards({placed}, *camera, options);
  const auto edge = camera->Project(
      {placed.X_CB * Eigen::Vector3d(0, 15, 0), placed.X_CB * Eigen::Vector3d(0, 14, 0)});
  const double slope = (edge[0].x() - edge[1].x()) / (edge[0].y() - edge[1].y());
  const int row = static_cast<int>(std::round(edge[0].y()));
  const int u = static_cast<int>(std::round(edge[0].x()));
  EXPECT_NEAR(EdgeFrom(picture, row, u - 8, u + 9), edge[0].x() + slope * (row - edge[0].y()),
              0.005);
}

}  // namespace
}  // namespace turnlight::rig::sim
