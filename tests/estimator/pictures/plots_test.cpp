// Proves that maps and plots put values where their axes say, and that strange input (all
// unobserved, one value, huge, not finite) is drawn without a crash and without text cut at the
// page's edge. Does not prove that the pictures please: that takes eyes.
#include "estimator/pictures/plots.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/angles.h"
#include "base/plot/canvas.h"
#include "tests/base/plot/clear_edge.h"
#include "tests/base/plot/lightness.h"

namespace turnlight::estimator::pictures {
namespace {

using Eigen::Vector3d;
using plot::ExpectClearEdge;
using plot::Lightness;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

bool Contains(const cv::Mat3b& page, const cv::Vec3b& colour) {
  for (const cv::Vec3b& pixel : page)
    if (pixel == colour) return true;
  return false;
}

TEST(ResidualPicture, ShowsEachValueInItsColour) {
  cv::Mat1f residual(60, 80, 0.0f);
  residual(10, 20) = 0.01f;
  residual(11, 20) = -0.005f;
  residual(12, 20) = kNan;
  const cv::Mat3b page = ResidualPicture(residual, 0.01, 6, "a title");
  ExpectClearEdge(page);
  // The picture begins below the title and right of the margin.
  const auto at = [&](int row, int column) {
    return page(44 + 6 * row + 3, plot::kMargin + 6 * column + 3);
  };
  EXPECT_EQ(at(10, 20), plot::DivergingColour(1.0));
  EXPECT_EQ(at(11, 20), plot::DivergingColour(-0.5));
  EXPECT_EQ(at(12, 20), plot::kUnobserved);
  EXPECT_EQ(at(13, 20), plot::DivergingColour(0.0));
}

TEST(ResidualPicture, BarIsSymmetric) {
  const cv::Mat3b page = ResidualPicture(cv::Mat1f(60, 80, 0.0f), 0.02, 6, "t");
  const int x = plot::kMargin + 480 + plot::kMargin + 8, top = 44, height = 360;
  EXPECT_GE(page(top + height / 2, x)[0], 253);
  for (int i = 0; i < height / 2; i += 10) {
    const cv::Vec3b& above = page(top + i, x);
    const cv::Vec3b& below = page(top + height - 1 - i, x);
    EXPECT_NEAR(Lightness(above), Lightness(below), 4.0);
    EXPECT_GE(above[0], above[2]);
    EXPECT_GE(below[2], below[0]);
  }
}

TEST(ResidualRange, CoversNearlyAllAndIgnoresTheUnobserved) {
  cv::Mat1f residual(100, 100, 0.0f);
  for (int i = 0; i < 10000; ++i) residual(i / 100, i % 100) = (i % 2 ? -1.0f : 1.0f) * 3e-6f * i;
  residual(0, 0) = kNan;
  EXPECT_EQ(ResidualRange({residual}), 0.05);
  EXPECT_EQ(ResidualRange({cv::Mat1f(3, 3, kNan)}), 1.0);
  EXPECT_EQ(ResidualRange({cv::Mat1f(3, 3, 0.0f)}), 1.0);
  EXPECT_EQ(ResidualRange({}), 1.0);
}

TEST(ResidualPicture, StrangeValuesAreDrawn) {
  for (const float value : {kNan, 0.0f, 1e30f, -1e30f, kInf, 1e-30f}) {
    const cv::Mat1f residual(30, 40, value);
    ExpectClearEdge(ResidualPicture(residual, ResidualRange({residual}), 12, "strange"));
  }
}

LightEstimate LightAt(double azimuth_deg, double zenith_deg, double sigma_deg) {
  const double azimuth = DegToRad(azimuth_deg), zenith = DegToRad(zenith_deg);
  LightEstimate light;
  light.direction_at_reference = {std::sin(zenith) * std::cos(azimuth),
                                  std::sin(zenith) * std::sin(azimuth), std::cos(zenith)};
  light.light.direction = light.direction_at_reference;
  light.direction_sigma = DegToRad(sigma_deg);
  return light;
}

TEST(IntensityPicture, MarksLightsAtTheirAngles) {
  observe::IntensityMap map{cv::Mat1f(180, 360, 0.5f)};
  const cv::Mat3b without = IntensityPicture(map, {});
  const cv::Mat3b with = IntensityPicture(map, {LightAt(120, 30, 0.0)});
  ExpectClearEdge(with);
  // The map begins at (84, 44) and has 3 pixels per degree: a ring of radius 9 around the light.
  cv::Mat1b changed(540, 1080, uchar{0});
  for (int row = 0; row < 540; ++row)
    for (int column = 0; column < 1080; ++column)
      if (with(44 + row, 84 + column) != without(44 + row, 84 + column)) changed(row, column) = 255;
  EXPECT_EQ(changed(90, 360), 0);
  for (const cv::Point d : {cv::Point(9, 0), {-9, 0}, {0, 9}, {0, -9}})
    EXPECT_EQ(changed(cv::Point(360, 90) + d), 255);
  EXPECT_EQ(cv::countNonZero(changed(cv::Rect(400, 0, 680, 540))), 0);
}

TEST(IntensityPicture, EllipseWidensTowardsThePole) {
  observe::IntensityMap map{cv::Mat1f(180, 360, 0.5f)};
  const cv::Mat3b without = IntensityPicture(map, {});
  const cv::Mat3b with = IntensityPicture(map, {LightAt(180, 30, 5.0)});
  // 3 sigma = 15 degrees: upwards 45 pixels; sideways asin(sin 15 / sin 30) = 31.2 degrees.
  const auto marked = [&](int x, int y) { return with(44 + y, 84 + x) != without(44 + y, 84 + x); };
  EXPECT_TRUE(marked(540, 45) || marked(540, 44));
  EXPECT_TRUE(marked(540, 135) || marked(540, 134));
  const double half_width = 3.0 * RadToDeg(std::asin(std::sin(DegToRad(15)) / 0.5));
  const int y = static_cast<int>(
      std::lround(3.0 * RadToDeg(std::acos(std::cos(DegToRad(30)) / std::cos(DegToRad(15))))));
  EXPECT_TRUE(marked(static_cast<int>(540 + half_width), y));
  EXPECT_TRUE(marked(static_cast<int>(540 - half_width), y));
}

TEST(IntensityPicture, GapsWithinWhatWasSeenAreClosedAndItsBorderStays) {
  cv::Mat1f map(180, 360, kNan);
  for (int row = 40; row < 60; ++row)
    for (int column = 340; column < 380; ++column)
      if ((row + column) % 2 == 0) map(row, column % 360) = 0.5f;
  const cv::Mat3b page = IntensityPicture({map}, {});
  const auto at = [&](int row, int column) { return page(44 + 3 * row + 1, 84 + 3 * column + 1); };
  EXPECT_EQ(at(51, 359), plot::SequentialColour(1.0));
  EXPECT_EQ(at(50, 0), plot::SequentialColour(1.0));
  EXPECT_EQ(at(50, 1), plot::SequentialColour(1.0));
  EXPECT_EQ(at(38, 0), plot::kUnseen);
  EXPECT_EQ(at(61, 10), plot::kUnseen);
  EXPECT_EQ(at(50, 337), plot::kUnseen);
}

TEST(IntensityPicture, StrangeMapsAndLightsAreDrawn) {
  const std::vector<LightEstimate> lights{LightAt(0, 0, 1),     LightAt(359.99, 90, 20),
                                          LightAt(10, 180, 5),  LightAt(200, 60, NAN),
                                          LightAt(30, 2, 1000), LightAt(0, 89, HUGE_VAL)};
  for (const cv::Size size :
       {cv::Size(360, 180), cv::Size(1, 1), cv::Size(77, 33), cv::Size(720, 360)})
    for (const float value : {kNan, 0.0f, 1e30f, -1.0f, kInf})
      ExpectClearEdge(IntensityPicture({cv::Mat1f(size, value)}, lights));
  EXPECT_TRUE(Contains(IntensityPicture({cv::Mat1f(18, 36, kNan)}, {}), plot::kUnseen));
}

TEST(ConvergencePicture, FallingResidualFallsOnThePage) {
  const cv::Mat3b page = ConvergencePicture({{0, 0.1}, {1, 0.01}, {2, 0.001}});
  ExpectClearEdge(page);
  // A straight line in logarithms: the middle point is at the middle of the area, 100..724
  // by 44..414.
  EXPECT_EQ(page(229, 412), plot::DivergingColour(-0.9));
  EXPECT_EQ(page(44, 100), plot::DivergingColour(-0.9));
}

TEST(ConvergencePicture, StrangeHistoriesAreDrawn) {
  const std::vector<std::vector<IterationRecord>> histories{{{0, 0.1}},
                                                            {{0, 0.0}},
                                                            {{0, NAN}, {1, HUGE_VAL}},
                                                            {{0, 1e-300}, {1, 1e300}},
                                                            {{0, 1e-12}, {400, 1e-13}},
                                                            {{5, 0.02}, {5, 0.02}},
                                                            {{0, 0.3}, {100000, 0.1}}};
  for (const auto& history : histories) ExpectClearEdge(ConvergencePicture(history));
}

}  // namespace
}  // namespace turnlight::estimator::pictures
