// Proves: a lens comes back from simulated corners within its uncertainty, for each lens model,
// wide lenses, half-hidden boards, several boards in a picture and grids of tags; wrong points and
// wrong views are found; what does not determine a lens is refused with words that help. Does not
// prove: that corners are found in pictures.
#include "calib/calibrate/lens/calibrate_lens.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "calib/calibrate/board/number_lattice.h"
#include "calib/calibrate/lens/cross_validation.h"
#include "calib/calibrate/lens/lens_model_name.h"
#include "calib/calibrate/lens/projection_difference.h"
#include "simulated_views.h"

namespace turnlight::calib::calibrate::lens {
namespace {

using testing::HasSubstr;

LensCalibration Calibrated(const board::Board& board, const std::vector<PictureViews>& pictures,
                           const std::string& model = "OPENCV8") {
  LensOptions options;
  options.lens_model = *FullLensModelName(model, "test");
  auto calibration = CalibrateLens(board, pictures, options);
  if (!calibration) ADD_FAILURE() << calibration.error().text;
  return *calibration;
}

std::string Refusal(const board::Board& board, const std::vector<PictureViews>& pictures) {
  const auto calibration = CalibrateLens(board, pictures, {});
  return calibration ? "calibrated" : calibration.error().text;
}

// Root mean square of the differences to the truth, in sigmas, over the covered area.
double MissInSigmas(const LensCalibration& calibration, const CameraModel& truth) {
  const ImageGrid grid = GridOverImage(truth.width(), truth.height(), 20);
  const auto covered = CoveredPixels(calibration, grid.pixels);
  const auto difference = ProjectionDifference(calibration.camera(), truth, grid.pixels,
                                               std::vector<double>(covered.begin(), covered.end()));
  if (!difference) ADD_FAILURE() << difference.error().text;
  const auto covariance = calibration.uncertainty.At(grid.pixels);
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < covered.size(); ++i) {
    if (!covered[i]) continue;
    sum += difference->px[i].squaredNorm() / covariance[i].trace();
    count += 1.0;
  }
  return std::sqrt(sum / count);
}

TEST(CalibrateLens, FindsTheLensAndTheBend) {
  SimulatedViews how;
  how.warp = {0.15, -0.1};
  const auto calibration =
      Calibrated(ExampleBoard(), SimulateViews(ExampleLens(), ExampleBoard(), how));
  EXPECT_NEAR(calibration.rms_px, 0.3, 0.02);
  EXPECT_NEAR(calibration.warp.x(), 0.15, 0.03);
  EXPECT_NEAR(calibration.warp.y(), -0.1, 0.03);
  EXPECT_EQ(calibration.views.size(), 20u);
  EXPECT_TRUE(calibration.dropped.empty());
  EXPECT_TRUE(calibration.shape.empty());
  EXPECT_LT(MissInSigmas(calibration, ExampleLens()), 2.0);
}

TEST(CalibrateLens, FitsEveryModelThatSuitsTheLens) {
  SimulatedViews how;
  how.pictures = 12;
  const auto pictures = SimulateViews(ExampleLens(), ExampleBoard(), how);
  for (const char* model : {"OPENCV4", "OPENCV5", "OPENCV12", "CAHVOR",
                            "SPLINED_STEREOGRAPHIC_order=2_Nx=10_Ny=7_fov_x_deg=70"})
    EXPECT_NEAR(Calibrated(ExampleBoard(), pictures, model).rms_px, 0.3, 0.03) << model;
  const CameraModel pinhole = CameraModel::Pinhole(1600, 1200, 1500.0, 1490.0, 810.0, 590.0);
  EXPECT_NEAR(
      Calibrated(ExampleBoard(), SimulateViews(pinhole, ExampleBoard(), how), "PINHOLE").rms_px,
      0.3, 0.03);
}

TEST(CalibrateLens, FindsWideAndLongLensesWithoutAHint) {
  SimulatedViews how;
  how.width_share = 0.35;
  how.pictures = 24;
  const auto fisheye = *CameraModel::FromString(
      "{'lensmodel': 'LENSMODEL_STEREOGRAPHIC', 'extrinsics': [0,0,0,0,0,0], "
      "'imagersize': [2000, 1400], 'intrinsics': [450, 450, 1010, 690]}",
      "test");
  const auto wide =
      Calibrated(ExampleBoard(), SimulateViews(fisheye, ExampleBoard(), how), "STEREOGRAPHIC");
  EXPECT_LT(MissInSigmas(wide, fisheye), 2.5);
  how.width_share = 0.5;
  const auto tele = CameraModel::Pinhole(2000, 1400, 12000.0, 12000.0, 1000.0, 700.0);
  const auto narrow =
      Calibrated(ExampleBoard(), SimulateViews(tele, ExampleBoard(), how), "OPENCV4");
  EXPECT_LT(MissInSigmas(narrow, tele), 2.5);
}

TEST(CalibrateLens, TakesHalfHiddenBoardsAndSeveralInAPicture) {
  auto pictures = SimulateViews(ExampleLens(), ExampleBoard(), {});
  for (std::size_t k = 0; k < 10; ++k)
    std::erase_if(pictures[k].boards[0].points,
                  [&](const board::SeenPoint& seen) { return seen.point % 10 > 3 + k % 3; });
  pictures[0].boards.push_back(pictures.back().boards[0]);
  pictures.pop_back();
  const auto calibration = Calibrated(ExampleBoard(), pictures);
  EXPECT_EQ(calibration.views.size(), 20u);
  EXPECT_EQ(calibration.views[1].picture, 0u);
  EXPECT_EQ(calibration.views[1].board, 1u);
  EXPECT_LT(MissInSigmas(calibration, ExampleLens()), 2.5);
}

TEST(CalibrateLens, TakesGridsOfTags) {
  const board::Board tags{board::BoardKind::kAprilTagGrid, 4, 4, 39.0, 30.0, "APRILTAG_36h11"};
  SimulatedViews how;
  how.pictures = 10;
  const auto calibration = Calibrated(tags, SimulateViews(ExampleLens(), tags, how));
  EXPECT_NEAR(calibration.rms_px, 0.3, 0.03);
  EXPECT_LT(MissInSigmas(calibration, ExampleLens()), 2.5);
}

TEST(CalibrateLens, MarksPointsThatAreFarOff) {
  auto pictures = SimulateViews(ExampleLens(), ExampleBoard(), {});
  for (std::size_t k = 0; k < pictures.size(); ++k)
    pictures[k].boards[0].points[7 * k % 80].pixel += Eigen::Vector2d(5.0 + double(k), 3.0);
  const auto calibration = Calibrated(ExampleBoard(), pictures);
  EXPECT_EQ(calibration.outliers, pictures.size());
  EXPECT_NEAR(calibration.rms_px, 0.3, 0.02);
}

TEST(CalibrateLens, DropsAViewThatDoesNotFit) {
  auto pictures = SimulateViews(ExampleLens(), ExampleBoard(), {});
  for (board::SeenPoint& seen : pictures[3].boards[0].points) seen.pixel.x() *= 0.8;
  for (board::SeenPoint& seen : pictures[3].boards[0].points)
    seen.pixel.x() += 30.0 * static_cast<double>(seen.point % 3);
  const auto calibration = Calibrated(ExampleBoard(), pictures);
  ASSERT_EQ(calibration.dropped.size(), 1u);
  EXPECT_EQ(calibration.dropped[0].picture, 3u);
  EXPECT_THAT(calibration.dropped[0].reason, HasSubstr("does not fit: its points lie"));
}

TEST(CalibrateLens, FitsTheShapeOfABoardThatIsNotFlat) {
  SimulatedViews how;
  how.wave = 1.0;
  const auto pictures = SimulateViews(ExampleLens(), ExampleBoard(), how);
  const auto calibration = Calibrated(ExampleBoard(), pictures);
  EXPECT_NEAR(calibration.rms_px, 0.3, 0.03);
  EXPECT_EQ(calibration.shape.size(), 100u);
  ASSERT_FALSE(calibration.notes.empty());
  EXPECT_THAT(calibration.notes[0], HasSubstr("The board is not flat"));
  EXPECT_LT(MissInSigmas(calibration, ExampleLens()), 2.5);
  LensOptions flat;
  flat.fits_warp = flat.fits_shape = false;
  const auto biased = CalibrateLens(ExampleBoard(), pictures, flat);
  ASSERT_TRUE(biased) << biased.error().text;
  EXPECT_GT(biased->rms_px, 1.0);
  EXPECT_TRUE(biased->shape.empty());
}

TEST(CalibrateLens, FindsTheShapeThoughTheBoardIsNumberedFromAnySide) {
  SimulatedViews how;
  how.wave = 1.0;
  auto pictures = SimulateViews(ExampleLens(), ExampleBoard(), how);
  const auto ways = board::SameLookingNumberings(ExampleBoard());
  ASSERT_EQ(ways.size(), 4u);
  for (std::size_t i = 0; i < pictures.size(); ++i)
    for (board::SeenPoint& seen : pictures[i].boards[0].points)
      seen.point = ways[i * 7 % 4][seen.point];
  const auto calibration = Calibrated(ExampleBoard(), pictures);
  EXPECT_NEAR(calibration.rms_px, 0.3, 0.03);
  EXPECT_EQ(calibration.shape.size(), 100u);
}

TEST(CalibrateLens, AMirroredChessboardIsAChessboard) {
  auto pictures = SimulateViews(ExampleLens(), ExampleBoard(), {});
  for (PictureViews& picture : pictures)
    for (board::SeenPoint& seen : picture.boards[0].points)
      seen.point = seen.point / 10 * 10 + 9 - seen.point % 10;
  EXPECT_NEAR(Calibrated(ExampleBoard(), pictures).rms_px, 0.3, 0.02);
  board::Board charuco = ExampleBoard();
  charuco.kind = board::BoardKind::kCharuco;
  EXPECT_THAT(
      Refusal(charuco, pictures),
      HasSubstr("the board is mirrored: it was printed mirrored, or the picture is flipped"));
}

TEST(CalibrateLens, NamesPicturesThatAreOfAnotherSize) {
  auto pictures = SimulateViews(ExampleLens(), ExampleBoard(), {});
  pictures[4].width = 1000;
  EXPECT_THAT(Refusal(ExampleBoard(), pictures),
              HasSubstr("p04 (1000 x 1400): other sizes than the 19 pictures of 2000 x 1400"));
}

TEST(CalibrateLens, SaysWhyNoneOrOneIsNotEnough) {
  auto pictures = SimulateViews(ExampleLens(), ExampleBoard(), {});
  const std::vector<PictureViews> one{pictures[0]};
  EXPECT_THAT(Refusal(ExampleBoard(), one),
              HasSubstr("one view of the board (p00) does not determine a lens: allowed are at "
                        "least 2"));
  for (PictureViews& picture : pictures) picture.boards.clear();
  pictures[2].why_none = "too blurred";
  EXPECT_THAT(Refusal(ExampleBoard(), pictures),
              testing::AllOf(HasSubstr("none of the 20 pictures shows the board"),
                             HasSubstr("19: no board found (p00, ...)"),
                             HasSubstr("1: too blurred (p02)")));
  EXPECT_THAT(Refusal(ExampleBoard(), {}), HasSubstr("no pictures"));
}

TEST(CalibrateLens, DropsViewsOfFewPointsOrOnALine) {
  auto pictures = SimulateViews(ExampleLens(), ExampleBoard(), {});
  pictures[0].boards[0].points.resize(5);
  pictures[1].boards[0].points.resize(10);
  const auto calibration = Calibrated(ExampleBoard(), pictures);
  ASSERT_EQ(calibration.dropped.size(), 2u);
  EXPECT_THAT(calibration.dropped[0].reason, HasSubstr("5 points of the board found, at least 6"));
  EXPECT_THAT(calibration.dropped[1].reason, HasSubstr("on a line"));
}

TEST(CalibrateLens, ParallelBoardsDoNotDetermineAFocalLength) {
  SimulatedViews how;
  how.pictures = 10;
  how.tilt_deg = 0.5;
  EXPECT_THAT(Refusal(ExampleBoard(), SimulateViews(ExampleLens(), ExampleBoard(), how)),
              testing::AllOf(HasSubstr("do not determine the lens"), HasSubstr("tilt the board")));
  how.tilt_deg = 4.0;
  const auto weak = Calibrated(ExampleBoard(), SimulateViews(ExampleLens(), ExampleBoard(), how));
  ASSERT_EQ(weak.notes.size(), 1u);
  EXPECT_THAT(weak.notes[0], HasSubstr("tilt the board"));
  EXPECT_LT(MissInSigmas(weak, ExampleLens()), 3.0);
}

TEST(CalibrateLens, TwoViewsHaveALargeUncertaintyThatIsTrue) {
  SimulatedViews how;
  how.pictures = 2;
  const auto few = Calibrated(ExampleBoard(), SimulateViews(ExampleLens(), ExampleBoard(), how));
  ASSERT_EQ(few.notes.size(), 1u);
  EXPECT_THAT(few.notes[0], HasSubstr("2 views"));
  EXPECT_FALSE(few.warp_fitted);
  EXPECT_LT(MissInSigmas(few, ExampleLens()), 3.0);
}

TEST(CalibrateLens, TwoHundredPicturesDo) {
  SimulatedViews how;
  how.pictures = 200;
  const board::Board board = ExampleBoard(7, 5);
  const auto calibration = Calibrated(board, SimulateViews(ExampleLens(), board, how));
  EXPECT_EQ(calibration.views.size(), 200u);
  EXPECT_NEAR(calibration.rms_px, 0.3, 0.02);
}

}  // namespace
}  // namespace turnlight::calib::calibrate::lens
