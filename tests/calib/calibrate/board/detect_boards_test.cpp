// Proves: boards that are rendered with known truth are found to some hundredths of a pixel,
// turned, oblique, through a strong lens, small, blurred, noisy, several, half hidden; and what is
// told of those that are not. Does not prove that real photographs are as good:
// real_boards_test.cpp looks at some.
#include "calib/calibrate/board/detect_boards.h"

#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>

#include "base/parallel.h"
#include "tests/calib/calibrate/board/rendered_board.h"

namespace turnlight::calib::calibrate::board {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Detection Detected(const cv::Mat& picture, const Board& board) {
  const auto detection = DetectBoards(picture, board);
  EXPECT_TRUE(detection) << detection.error().text;
  return detection.value_or(Detection{});
}

// One whole board, as near to the truth as asked.
void ExpectFound(const Board& board, const View& view, double median, double worst,
                 const rig::sim::BoardPictureOptions& options = {}, double k1 = -0.1) {
  const auto camera = TestCamera(k1);
  const auto placed = Place(board, view);
  const auto detection = Detected(rig::sim::RenderBoards({placed}, camera, options), board);
  ASSERT_EQ(detection.boards.size(), 1u) << testing::PrintToString(detection.remarks);
  EXPECT_EQ(detection.boards[0].view.points.size(), board.PointCount());
  const Misfit misfit = MisfitOf(detection.boards[0].view, placed, camera);
  EXPECT_LT(misfit.median, median);
  EXPECT_LT(misfit.worst, worst);
}

TEST(DetectBoards, ChessboardsTurnedByAnyAngle) {
  for (int roll = 0; roll < 360; roll += 40) {
    SCOPED_TRACE(roll);
    ExpectFound(Chessboard(9, 6), {20.0, 30.0, static_cast<double>(roll), 450.0}, 0.05, 0.2);
    ExpectFound(Chessboard(7, 7), {20.0, 30.0, static_cast<double>(roll), 450.0}, 0.05, 0.2);
  }
}

TEST(DetectBoards, ObliqueTo60DegreesAndThroughAStrongLens) {
  for (const double axis : {0.0, 50.0, 90.0, 140.0}) {
    SCOPED_TRACE(axis);
    ExpectFound(Chessboard(10, 7), {60.0, axis, 25.0, 400.0}, 0.05, 0.3);
  }
  ExpectFound(Chessboard(10, 10), {30.0, 20.0, 5.0, 400.0}, 0.05, 0.3, {}, -0.3);
  ExpectFound(Chessboard(10, 10), {30.0, 20.0, 5.0, 400.0}, 0.05, 0.3, {}, 0.2);
}

TEST(DetectBoards, BlurredNoisySmallAndDark) {
  rig::sim::BoardPictureOptions options;
  options.blur_sigma = 2.5;
  ExpectFound(Chessboard(9, 6), {30.0, 20.0, 5.0, 400.0}, 0.05, 0.2, options);
  options = {};
  options.noise_sigma = 0.02;  // 5 of 255 levels
  ExpectFound(Chessboard(9, 6), {30.0, 20.0, 5.0, 400.0}, 0.06, 0.25, options);
  ExpectFound(Chessboard(9, 6), {10.0, 20.0, 5.0, 1100.0}, 0.08, 0.35);  // squares of 12 pixels
  options = {};
  options.depth = CV_16U;
  options.bright = 0.04;
  options.dark = 0.004;
  options.background = 0.02;
  ExpectFound(Chessboard(9, 6), {30.0, 20.0, 5.0, 400.0}, 0.05, 0.2, options);
}

TEST(DetectBoards, MarkersAndTags) {
  const Board charuco{BoardKind::kCharuco, 8, 5, 22.0, 16.0, "5X5_100"};
  const Board tags{BoardKind::kAprilTagGrid, 5, 4, 35.0, 27.0, "APRILTAG_36h11"};
  for (const double roll : {0.0, 100.0, 220.0}) {
    ExpectFound(charuco, {30.0, 40.0, roll, 400.0}, 0.08, 0.3);
    ExpectFound(tags, {30.0, 40.0, roll, 400.0}, 0.05, 0.3);
  }
}

TEST(DetectBoards, MarkersOfPartsAndOfTwoBoards) {
  const Board charuco{BoardKind::kCharuco, 6, 4, 20.0, 15.0, "4X4_50"};
  const auto camera = TestCamera();
  const auto left = Place(charuco, {10.0, 0.0, 0.0, 450.0, -90.0});
  const auto right = Place(charuco, {10.0, 90.0, 15.0, 450.0, 90.0});
  cv::Mat picture = rig::sim::RenderBoards({left, right}, camera);
  picture(cv::Rect(0, 0, 800, 290)).setTo(100);  // hides the upper half of both
  const auto detection = Detected(picture, charuco);
  ASSERT_EQ(detection.boards.size(), 2u);
  for (const DetectedBoard& found : detection.boards) {
    EXPECT_GE(found.view.points.size(), 8u);
    EXPECT_THAT(found.remarks, ElementsAre(HasSubstr("of 24 points seen")));
    EXPECT_LT(std::min(MisfitOf(found.view, left, camera).worst,
                       MisfitOf(found.view, right, camera).worst),
              0.3);
  }
}

TEST(DetectBoards, TwoChessboardsThatMeetInACornerOfARoom) {
  const auto camera = TestCamera();
  const auto left = Place(Chessboard(7, 7), {40.0, 90.0, 0.0, 500.0, -72.0});
  const auto right = Place(Chessboard(7, 7), {-40.0, 90.0, 0.0, 500.0, 72.0});
  const auto detection = Detected(rig::sim::RenderBoards({left, right}, camera), Chessboard(7, 7));
  ASSERT_EQ(detection.boards.size(), 2u);
  for (const DetectedBoard& found : detection.boards) {
    EXPECT_EQ(found.view.points.size(), 49u);
    EXPECT_LT(std::min(MisfitOf(found.view, left, camera).worst,
                       MisfitOf(found.view, right, camera).worst),
              0.2);
  }
}

// The part of the board beyond an upright line is covered by something grey.
Detection HalfHidden(const rig::sim::PlacedBoard& placed, int first_hidden, const Board& said) {
  cv::Mat picture = rig::sim::RenderBoards({placed}, TestCamera());
  picture(cv::Rect(first_hidden, 0, picture.cols - first_hidden, picture.rows)).setTo(90);
  return Detected(picture, said);
}

TEST(DetectBoards, AHalfHiddenChessboardIsNumberedFromTheEndThatShows) {
  const auto placed = Place(Chessboard(9, 6), {15.0, 20.0, 8.0, 450.0});
  const auto detection = HalfHidden(placed, 420, Chessboard(9, 6));
  ASSERT_EQ(detection.boards.size(), 1u) << testing::PrintToString(detection.remarks);
  EXPECT_GE(detection.boards[0].view.points.size(), 20u);
  EXPECT_LT(detection.boards[0].view.points.size(), 54u);
  EXPECT_LT(MisfitOf(detection.boards[0].view, placed, TestCamera()).worst, 0.2);
}

TEST(DetectBoards, RowsThatAreHiddenAreNumberedFromTheEndThatShowsToo) {
  const auto placed = Place(Chessboard(9, 6), {15.0, 20.0, 3.0, 450.0});
  for (const bool upper : {true, false}) {
    cv::Mat picture = rig::sim::RenderBoards({placed}, TestCamera());
    picture(cv::Rect(0, upper ? 0 : 310, 800, 290)).setTo(90);
    const auto detection = Detected(picture, Chessboard(9, 6));
    ASSERT_EQ(detection.boards.size(), 1u) << testing::PrintToString(detection.remarks);
    EXPECT_LT(detection.boards[0].view.points.size(), 45u);
    EXPECT_LT(MisfitOf(detection.boards[0].view, placed, TestCamera()).worst, 0.2);
  }
}

TEST(DetectBoards, AChessboardWithoutAnEndInSightIsLeftOutAndTold) {
  const auto placed = Place(Chessboard(9, 6), {15.0, 20.0, 8.0, 450.0});
  cv::Mat picture = rig::sim::RenderBoards({placed}, TestCamera());
  picture(cv::Rect(0, 0, 330, 600)).setTo(90);
  picture(cv::Rect(500, 0, 300, 600)).setTo(90);
  const auto detection = Detected(picture, Chessboard(9, 6));
  EXPECT_THAT(detection.boards, IsEmpty());
  EXPECT_THAT(detection.remarks, ElementsAre(HasSubstr("left out")));
}

TEST(DetectBoards, AnotherSizeIsTold) {
  const auto placed = Place(Chessboard(9, 6), {15.0, 20.0, 8.0, 450.0});
  const cv::Mat picture = rig::sim::RenderBoards({placed}, TestCamera());
  for (const Board& said : {Chessboard(10, 7), Chessboard(8, 6), Chessboard(5, 5)}) {
    const auto detection = Detected(picture, said);
    EXPECT_THAT(detection.boards, IsEmpty());
    EXPECT_THAT(detection.remarks, ElementsAre(HasSubstr("shows 9 x 6 inner corners")));
  }
  EXPECT_EQ(Detected(picture, Chessboard(6, 9)).boards.size(), 1u);  // said the other way round
}

TEST(DetectBoards, BlurAndOverexposureAreTold) {
  rig::sim::BoardPictureOptions options;
  options.blur_sigma = 4.0;
  options.bright = 1.5;
  const auto placed = Place(Chessboard(9, 6), {15.0, 20.0, 8.0, 400.0});
  const auto detection =
      Detected(rig::sim::RenderBoards({placed}, TestCamera(), options), Chessboard(9, 6));
  ASSERT_EQ(detection.boards.size(), 1u);
  EXPECT_THAT(detection.boards[0].remarks,
              ElementsAre(HasSubstr("blurred"), HasSubstr("overexposed")));
  EXPECT_GT(detection.boards[0].view.points[0].spread, 1.5);
  EXPECT_GT(detection.boards[0].saturated, 0.5);
}

TEST(DetectBoards, AMirroredPrintIsTold) {
  for (const Board& board : {Board{BoardKind::kCharuco, 6, 4, 20.0, 15.0, "4X4_50"},
                             Board{BoardKind::kAprilTagGrid, 4, 4, 35.0, 27.0, "tag36h11"}}) {
    cv::Mat picture = rig::sim::RenderBoards({Place(board, {})}, TestCamera());
    cv::flip(picture, picture, 1);
    const auto detection = Detected(picture, board);
    EXPECT_THAT(detection.boards, IsEmpty());
    EXPECT_THAT(detection.remarks, ElementsAre(HasSubstr("mirror")));
  }
}

TEST(DetectBoards, PicturesWithoutABoardSayWhatTheyAre) {
  const auto remarks = [](const cv::Mat& picture, const Board& board) {
    const auto detection = Detected(picture, board);
    EXPECT_THAT(detection.boards, IsEmpty());
    return testing::PrintToString(detection.remarks);
  };
  const Board board = Chessboard(9, 6);
  EXPECT_THAT(remarks(cv::Mat(600, 800, CV_8U, cv::Scalar(0)), board), HasSubstr("underexposed"));
  EXPECT_THAT(remarks(cv::Mat(600, 800, CV_8U, cv::Scalar(255)), board), HasSubstr("overexposed"));
  EXPECT_THAT(remarks(cv::Mat(600, 800, CV_16U, cv::Scalar(30000)), board), HasSubstr("contrast"));
  cv::Mat noise(600, 800, CV_8U);
  cv::RNG(7).fill(noise, cv::RNG::UNIFORM, 0, 256);
  EXPECT_THAT(remarks(noise, board), HasSubstr("no board found"));
  EXPECT_THAT(remarks(noise, {BoardKind::kCharuco, 6, 4, 20.0, 15.0, "4X4_50"}),
              HasSubstr("no marker"));
}

TEST(DetectBoards, RefusesWhatIsNoPicture) {
  const auto refused = [](const cv::Mat& picture) {
    const auto detection = DetectBoards(picture, Chessboard(9, 6));
    return detection ? std::string() : detection.error().text;
  };
  EXPECT_THAT(refused(cv::Mat()), HasSubstr("empty"));
  EXPECT_THAT(refused(cv::Mat(600, 800, CV_32F, cv::Scalar(std::nan("")))), HasSubstr("CV_32FC1"));
  EXPECT_THAT(refused(cv::Mat(600, 800, CV_8UC3)), HasSubstr("CV_8UC3"));
  EXPECT_THAT(refused(cv::Mat(3, 800, CV_8U)), HasSubstr("800 x 3"));
  EXPECT_FALSE(DetectBoards(cv::Mat(600, 800, CV_8U), Chessboard(1, 6)));
}

TEST(DetectInPictures, TheSameForAnyNumberOfThreads) {
  const Board board{BoardKind::kCharuco, 6, 4, 20.0, 15.0, "4X4_50"};
  const auto picture = [&](std::size_t i) -> Result<cv::Mat> {
    if (i == 3) return InputError("no such file");
    return rig::sim::RenderBoards({Place(board, {10.0 * static_cast<double>(i), 30.0})},
                                  TestCamera());
  };
  std::vector<std::vector<Eigen::Vector2d>> pixels;
  for (const int threads : {1, 2}) {
    SetThreads(threads);
    const auto found = DetectInPictures(5, picture, board);
    ASSERT_EQ(found.size(), 5u);
    EXPECT_FALSE(found[3]);
    pixels.emplace_back();
    for (const auto& detection : found)
      for (const auto& one : detection ? detection->boards : std::vector<DetectedBoard>())
        for (const SeenPoint& seen : one.view.points) pixels.back().push_back(seen.pixel);
  }
  SetThreads(0);
  EXPECT_GT(pixels[0].size(), 50u);
  EXPECT_EQ(pixels[0], pixels[1]);
}

}  // namespace
}  // namespace turnlight::calib::calibrate::board
