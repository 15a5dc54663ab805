// Proves: a known fall of light is found within 0.2 %, with its centre, through an encoding, beside
// dust and colours; an even field needs no correction; a white balance is the ratio of the card's
// light. Does not prove that a lab's surface is evenly lit.
#include "calib/calibrate/response/flat_field.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/calib/calibrate/response/sensor.h"

namespace turnlight::calib::calibrate::response {
namespace {

using testing::HasSubstr;

const cv::Size kSize(240, 180), kGrid(24, 18);

cv::Mat1d Field(double fall, double center_x, double center_y) {
  cv::Mat1d scene(kSize);
  for (int row = 0; row < kSize.height; ++row)
    for (int column = 0; column < kSize.width; ++column) {
      const double r = std::hypot(column - center_x, row - center_y) / 150.0;
      scene(row, column) = 0.6 * (1.0 - fall * r * r);
    }
  return scene;
}

Radiometry RadiometryOf(const SimulatedSensor& sensor) {
  Radiometry radiometry;
  radiometry.black = sensor.black;
  radiometry.white = sensor.White();
  return radiometry;
}

Result<FlatField> Fit(const SimulatedSensor& sensor, const Radiometry& radiometry,
                      const cv::Mat1d& scene, double exposure = 1.0) {
  std::vector<cv::Mat> pictures;
  for (std::uint64_t i = 0; i < 4; ++i) pictures.push_back(Expose(sensor, scene, exposure, 10 + i));
  const std::vector<Group> groups{MeasureGroup(pictures, std::nullopt, 1.0, sensor.black, kGrid)};
  return FitVignetting(groups, radiometry, sensor.White(), kSize, kGrid);
}

TEST(FlatField, AKnownFallIsFound) {
  for (const bool encoded : {false, true}) {
    SimulatedSensor sensor;
    Radiometry radiometry = RadiometryOf(sensor);
    if (encoded) {
      sensor.encode = [](double x) { return std::pow(x, 1.0 / 2.2); };
      radiometry.encoding = Encoding::kGamma;
      radiometry.gamma = 2.2;
    }
    const auto flat = Fit(sensor, radiometry, Field(0.3, 130.0, 80.0));
    ASSERT_TRUE(flat) << flat.error().text;
    EXPECT_TRUE(flat->significant);
    EXPECT_TRUE(flat->center_known);
    EXPECT_NEAR(flat->vignetting.center_x, 130.0, 3.0);
    EXPECT_NEAR(flat->vignetting.center_y, 80.0, 3.0);
    for (const cv::Point at : {cv::Point(0, 0), cv::Point(239, 179), cv::Point(60, 90)}) {
      const double r = std::hypot(at.x - 130.0, at.y - 80.0) / 150.0;
      EXPECT_NEAR(flat->vignetting.ShareAt(at.x, at.y), 1.0 - 0.3 * r * r, 2e-3) << at;
    }
    EXPECT_LT(flat->rms, 2e-3);
  }
}

TEST(FlatField, DustIsPassedOver) {
  SimulatedSensor sensor;
  cv::Mat1d scene = Field(0.3, 120.0, 90.0);
  scene(cv::Rect(40, 40, 12, 12)) *= 0.9;
  const auto flat = Fit(sensor, RadiometryOf(sensor), scene);
  ASSERT_TRUE(flat) << flat.error().text;
  EXPECT_NEAR(flat->vignetting.ShareAt(0.0, 0.0), 0.7, 2e-3);
}

TEST(FlatField, AnEvenFieldNeedsNothing) {
  SimulatedSensor sensor;
  const auto flat = Fit(sensor, RadiometryOf(sensor), Field(0.0, 120.0, 90.0));
  ASSERT_TRUE(flat) << flat.error().text;
  EXPECT_FALSE(flat->significant);
}

TEST(FlatField, ClippedFramesAreRefused) {
  SimulatedSensor sensor;
  const auto flat = Fit(sensor, RadiometryOf(sensor), Field(0.1, 120.0, 90.0), 2.0);
  ASSERT_FALSE(flat);
  EXPECT_THAT(flat.error().text, HasSubstr("neither clipped nor darker"));
}

TEST(WhiteBalance, IsTheRatioOfTheCardsLight) {
  Radiometry radiometry;
  radiometry.black = 10.0;
  radiometry.white = 250.0;
  cv::Mat picture(40, 40, CV_8UC3, cv::Scalar(250, 250, 250));
  const cv::Rect card(10, 10, 20, 20);
  picture(card).setTo(cv::Scalar(70, 110, 60));
  picture.at<cv::Vec3b>(15, 15) = {250, 250, 250};  // a hot pixel
  const auto found = FindWhiteBalance({picture}, std::nullopt, card, radiometry, 250.0);
  ASSERT_TRUE(found) << found.error().text;
  EXPECT_NEAR(found->balance[0], 0.6, 1e-12);
  EXPECT_EQ(found->balance[1], 1.0);
  EXPECT_NEAR(found->balance[2], 0.5, 1e-12);
  const auto clipped =
      FindWhiteBalance({picture}, std::nullopt, {5, 10, 20, 20}, radiometry, 250.0);
  ASSERT_FALSE(clipped);
  EXPECT_THAT(clipped.error().text, HasSubstr("are clipped"));
  cv::Mat grey(40, 40, CV_8U, cv::Scalar(100));
  const auto colourless = FindWhiteBalance({grey}, std::nullopt, card, radiometry, 250.0);
  ASSERT_FALSE(colourless);
  EXPECT_THAT(colourless.error().text, HasSubstr("no light in one of red, green and blue"));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::response
