// Proves: planes are the places of a mosaic's cells or a picture's channels; a block's noise is
// that of one picture, whatever its pixels differ by, its hot pixels show and the lamp did between
// the two pictures. Does not prove that real noise is normal.
#include "calib/calibrate/response/blocks.h"

#include <gtest/gtest.h>

#include "tests/calib/calibrate/response/sensor.h"

namespace turnlight::calib::calibrate::response {
namespace {

double MeanVariance(const Group& group) {
  double sum = 0.0;
  for (const Block& block : group.blocks) sum += *block.variance;
  return sum / static_cast<double>(group.blocks.size());
}

TEST(Planes, OfAMosaic) {
  const cv::Mat mosaic = (cv::Mat_<std::uint16_t>(3, 4) << 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12);
  const auto planes = PlanesOf(mosaic, "GRBG");
  ASSERT_EQ(planes.size(), 4u);
  EXPECT_EQ(cv::countNonZero(planes[0].values != (cv::Mat_<std::uint16_t>(2, 2) << 1, 3, 9, 11)),
            0);
  EXPECT_EQ(cv::countNonZero(planes[3].values != (cv::Mat_<std::uint16_t>(1, 2) << 6, 8)), 0);
  EXPECT_EQ(planes[1].channel, 0);
  EXPECT_EQ(planes[2].channel, 2);
  EXPECT_EQ(planes[3].PixelX(1), 3.0);
  EXPECT_EQ(PlaneName(planes, 3), "green (2nd)");
}

TEST(Planes, OfColourAndGrey) {
  const cv::Mat colour(2, 2, CV_8UC3, cv::Scalar(1, 2, 3));
  const auto planes = PlanesOf(colour, std::nullopt);
  ASSERT_EQ(planes.size(), 3u);
  EXPECT_EQ(planes[2].values.at<std::uint8_t>(1, 1), 3);
  EXPECT_EQ(PlaneName(PlanesOf(cv::Mat(2, 2, CV_8U), std::nullopt), 0), "grey");
}

TEST(Blocks, NoiseIsThatOfOnePicture) {
  SimulatedSensor sensor;
  const cv::Mat1d scene(120, 160, 0.4);
  const double expected = std::pow(sensor.Gain(), 2) * (4000.0 + 25.0) + kRoundingVariance;
  const Group plain = MeasureGroup({Expose(sensor, scene, 1.0, 1), Expose(sensor, scene, 1.0, 2)},
                                   std::nullopt, 1000.0, sensor.black, {8, 6});
  EXPECT_NEAR(MeanVariance(plain), expected, 0.03 * expected);
  EXPECT_LT(plain.flicker, 1e-3);
  EXPECT_NEAR(plain.blocks[0].differences, 399.0, 1.0);
}

TEST(Blocks, HotPixelsAndFlickerAreNoNoise) {
  SimulatedSensor sensor;
  sensor.hot = 0.002;
  sensor.prnu = 0.02;
  const cv::Mat1d scene = Ramp({160, 120}, 0.2, 0.6);
  const Group group = MeasureGroup({Expose(sensor, scene, 1.0, 1), Expose(sensor, scene, 1.03, 2)},
                                   std::nullopt, 1000.0, sensor.black, {8, 6});
  EXPECT_NEAR(group.flicker, 0.03, 2e-3);
  const double expected = std::pow(sensor.Gain(), 2) * (4000.0 + 25.0) + kRoundingVariance;
  EXPECT_NEAR(MeanVariance(group), expected, 0.06 * expected);
}

TEST(Blocks, OnePictureHasNoNoise) {
  SimulatedSensor sensor;
  const Group group = MeasureGroup({Expose(sensor, cv::Mat1d(32, 32, 0.4), 1.0, 1)}, std::nullopt,
                                   1.0, 0.0, {8, 6});
  EXPECT_EQ(group.blocks.size(), 16u);  // no smaller than 8 x 8
  EXPECT_FALSE(group.blocks[0].variance);
}

}  // namespace
}  // namespace turnlight::calib::calibrate::response
