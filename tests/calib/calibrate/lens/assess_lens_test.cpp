// Proves: the verdict's words follow the numbers: a corner without boards is named, a blurred
// picture is doubted, halves that noise cannot explain are said to disagree; the JSON holds it all,
// and the report has its pictures.
// Does not prove: that the pictures are beautiful.
#include "calib/calibrate/lens/assess_lens.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/random.h"
#include "calib/calibrate/lens/lens_json.h"
#include "calib/calibrate/lens/pictures.h"
#include "simulated_views.h"

namespace turnlight::calib::calibrate::lens {
namespace {

using testing::Contains;
using testing::HasSubstr;

struct Assessed {
  LensCalibration calibration;
  LensAssessment assessment;
};

Assessed Assess(const std::vector<PictureViews>& pictures,
                std::optional<double> distance = std::nullopt) {
  auto calibration = CalibrateLens(ExampleBoard(), pictures, {});
  if (!calibration) ADD_FAILURE() << calibration.error().text;
  LensAssessment assessment = AssessLens(ExampleBoard(), pictures, *calibration, {}, distance);
  return {std::move(*calibration), std::move(assessment)};
}

TEST(AssessLens, AGoodCalibrationHasNothingToAdd) {
  const auto good = Assess(SimulateViews(ExampleLens(), ExampleBoard(), {}));
  EXPECT_THAT(good.assessment.verdict,
              testing::AllOf(HasSubstr("px in the middle"), HasSubstr("all of the picture"),
                             HasSubstr("agree")));
  EXPECT_TRUE(good.assessment.doubtful.empty());
  ASSERT_TRUE(good.assessment.halves);
  EXPECT_LT(good.assessment.halves->rms_px, 2.5 * good.assessment.halves->expected_px);
  EXPECT_GT(good.assessment.covered_share, 0.7);
}

TEST(AssessLens, NamesWhatIsNotCovered) {
  auto pictures = SimulateViews(ExampleLens(), ExampleBoard(), {});
  for (PictureViews& picture : pictures)
    std::erase_if(picture.boards[0].points, [](const board::SeenPoint& seen) {
      return seen.pixel.x() > 1200.0 && seen.pixel.y() > 850.0;
    });
  const auto result = Assess(pictures);
  EXPECT_THAT(result.assessment.verdict, HasSubstr("the bottom right corner is not covered"));
  EXPECT_THAT(result.assessment.advice, Contains(HasSubstr("bottom right corner")));
  EXPECT_LT(result.assessment.regions[8].covered_share, 0.2);
}

TEST(AssessLens, DoubtsABlurredPicture) {
  auto pictures = SimulateViews(ExampleLens(), ExampleBoard(), {});
  const RandomStream random(3, 4);
  std::uint64_t index = 0;
  for (board::SeenPoint& seen : pictures[6].boards[0].points) {
    seen.pixel.x() += 0.9 * random.Normal(index++);
    seen.pixel.y() += 0.9 * random.Normal(index++);
  }
  const auto result = Assess(pictures);
  ASSERT_EQ(result.assessment.doubtful.size(), 1u);
  EXPECT_THAT(result.assessment.advice, Contains(HasSubstr("Look at p06, and leave it out")));
}

TEST(AssessLens, HalvesThatNoiseDoesNotExplainDisagree) {
  // In every other picture the lens distorts a little more: by 5 px at 1000 px from the middle.
  auto pictures = SimulateViews(ExampleLens(), ExampleBoard(), {});
  const Eigen::Vector2d middle(1000.0, 700.0);
  for (std::size_t i = 1; i < pictures.size(); i += 2)
    for (board::SeenPoint& seen : pictures[i].boards[0].points)
      seen.pixel += 5e-9 * (seen.pixel - middle).squaredNorm() * (seen.pixel - middle);
  const auto result = Assess(pictures);
  EXPECT_THAT(result.assessment.verdict, HasSubstr("disagree"));
}

TEST(AssessLens, SaysWhyThereIsNoCrossValidation) {
  SimulatedViews how;
  how.pictures = 4;
  const auto result = Assess(SimulateViews(ExampleLens(), ExampleBoard(), how));
  EXPECT_THAT(result.assessment.verdict,
              HasSubstr("No cross-validation: 4 pictures were used, two halves need at least 6"));
}

TEST(LensJson, HoldsEverything) {
  auto pictures = SimulateViews(ExampleLens(), ExampleBoard(), {});
  pictures[5].boards.clear();
  const auto result = Assess(pictures, 500.0);
  const auto json = nlohmann::json::parse(IntrinsicsJson(
      ExampleBoard(), pictures, result.calibration, result.assessment, "model", "mm"));
  EXPECT_EQ(json.at("format"), "turnlight-intrinsics");
  EXPECT_EQ(json.at("intrinsics").at("value").get<std::vector<double>>(),
            result.calibration.camera().intrinsics());
  EXPECT_EQ(json.at("intrinsics").at("covariance").size(), 12u);
  EXPECT_EQ(json.at("projection_covariance").size(), 18u);
  EXPECT_EQ(json.at("images").at("used").size(), 19u);
  EXPECT_EQ(json.at("images").at("dropped").at(0).at("image"), "p05");
  EXPECT_EQ(json.at("images").at("dropped").at(0).at("reason"), "no board found");
  EXPECT_EQ(json.at("uncertainty").at("worst_sigma_px").size(),
            json.at("uncertainty").at("rows").get<std::size_t>());
  EXPECT_EQ(json.at("uncertainty").at("at_distance").at("distance"), 500.0);
  EXPECT_TRUE(json.at("cross_validation").contains("rms_px"));
}

TEST(ReportPictures, AreThere) {
  const auto pictures = SimulateViews(ExampleLens(), ExampleBoard(), {});
  const auto result = Assess(pictures, 500.0);
  std::vector<std::string> names;
  for (const ReportPicture& picture :
       ReportPictures(pictures, result.calibration, result.assessment, "mm")) {
    names.push_back(picture.name);
    EXPECT_GT(picture.page.cols, 300);
  }
  EXPECT_THAT(names,
              testing::ElementsAre("residuals.png", "views.png", "histogram.png", "coverage.png",
                                   "uncertainty.png", "uncertainty_at_distance.png", "halves.png"));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::lens
