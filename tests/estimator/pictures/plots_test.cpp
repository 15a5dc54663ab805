// Proves that the colour maps are symmetric and monotone in lightness, that maps and plots put
// values where their axes say, and that strange input (all unobserved, one value, huge, not finite)
// is drawn without a crash and without text cut at the page's edge. Does not prove that the
// pictures please: that takes eyes.
#include "estimator/pictures/plots.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "base/angles.h"
#include "base/plot/canvas.h"
#include "base/plot/colours.h"

namespace turnlight::estimator::pictures {
namespace {

using Eigen::Vector3d;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

// CIE L* of a display colour.
double Lightness(const cv::Vec3b& color) {
  cv::Mat3f pixel(1, 1, cv::Vec3f(color) / 255.0f);
  cv::cvtColor(pixel, pixel, cv::COLOR_RGB2Lab);
  return pixel(0, 0)[0];
}

// Nothing is drawn within four pixels of the page's edge.
void ExpectClearEdge(const cv::Mat3b& page) {
  cv::Mat1b edge(page.size(), uchar{255});
  edge(cv::Rect(4, 4, page.cols - 8, page.rows - 8)).setTo(0);
  cv::Mat ink;
  cv::bitwise_not(page, ink);
  EXPECT_EQ(cv::norm(ink, cv::NORM_INF, edge), 0.0);
}

bool Contains(const cv::Mat3b& page, const cv::Vec3b& color) {
  for (const cv::Vec3b& pixel : page)
    if (pixel == color) return true;
  return false;
}

TEST(DivergingColor, IsSymmetricInLightnessFromWhiteToBlueAndRed) {
  EXPECT_EQ(plot::DivergingColor(0.0), cv::Vec3b(255, 255, 255));
  double previous = 101.0;
  for (double t = 0.0; t <= 1.0; t += 0.05) {
    const cv::Vec3b red = plot::DivergingColor(t), blue = plot::DivergingColor(-t);
    EXPECT_NEAR(Lightness(red), Lightness(blue), 4.0) << t;
    EXPECT_LT(Lightness(red), previous);
    previous = Lightness(red);
    if (t > 0.1) {
      EXPECT_GT(red[0], red[2] + 10) << t;
      EXPECT_GT(blue[2], blue[0] + 10) << t;
    }
  }
  EXPECT_EQ(plot::DivergingColor(1.0), plot::DivergingColor(1e30));
  EXPECT_EQ(plot::DivergingColor(-1.0), plot::DivergingColor(-kInf));
  EXPECT_EQ(plot::DivergingColor(kNan), plot::kUnobserved);
}

TEST(SequentialColor, GetsLighter) {
  for (double t = 0.0; t < 0.95; t += 0.05)
    EXPECT_LT(Lightness(plot::SequentialColor(t)), Lightness(plot::SequentialColor(t + 0.05)));
  EXPECT_EQ(plot::SequentialColor(-3.0), plot::SequentialColor(0.0));
  EXPECT_EQ(plot::SequentialColor(kInf), plot::SequentialColor(1.0));
  EXPECT_EQ(plot::SequentialColor(kNan), plot::kUnseen);
}

TEST(ToDisplay, EncodesAsSrgb) {
  cv::Mat3f radiance(1, 4, cv::Vec3f(0.5f, 0.0f, 1.0f));
  radiance(0, 1) = {-1.0f, 7.0f, kNan};
  radiance(0, 2) = {0.001f, kInf, -kInf};
  const cv::Mat3b shown = plot::ToDisplay(radiance, 1.0, 1);
  EXPECT_EQ(shown(0, 0), cv::Vec3b(188, 0, 255));
  EXPECT_EQ(shown(0, 1), cv::Vec3b(0, 255, 0));
  EXPECT_EQ(shown(0, 2), cv::Vec3b(3, 255, 0));
  EXPECT_EQ(plot::ToDisplay(radiance, 0.5, 3).size(), cv::Size(12, 3));
}

TEST(Percentile, IsTheNearestRank) {
  EXPECT_EQ(plot::Percentile({5, 1, 4, 2, 3}, 0.5), 3.0);
  EXPECT_EQ(plot::Percentile({5, 1, kNan, 4, 2, kInf, 3}, 1.0), 5.0);
  EXPECT_EQ(plot::Percentile({}, 0.5), 0.0);
  EXPECT_EQ(plot::Percentile({kNan}, 0.5), 0.0);
}

TEST(Canvas, NumbersForLabels) {
  EXPECT_EQ(plot::RoundUp(0.0003), 0.0005);
  EXPECT_EQ(plot::RoundUp(0.1), 0.1);
  EXPECT_EQ(plot::RoundUp(7.0), 10.0);
  EXPECT_EQ(plot::RoundUp(0.0), 1.0);
  EXPECT_EQ(plot::RoundUp(kInf), 1.0);
  EXPECT_DOUBLE_EQ(plot::RoundDown(0.0003), 0.0002);
  EXPECT_DOUBLE_EQ(plot::RoundDown(0.1), 0.1);
  EXPECT_DOUBLE_EQ(plot::RoundDown(7.0), 5.0);
  EXPECT_DOUBLE_EQ(plot::RoundDown(0.19), 0.1);
  EXPECT_EQ(plot::FormatNumber(-0.0), "0");
  EXPECT_EQ(plot::FormatNumber(0.00123456), "0.00123");
  EXPECT_EQ(plot::FormatNumber(-1.5e-6), "-1.5e-6");
  EXPECT_EQ(plot::FormatNumber(2e10), "2e10");
  EXPECT_EQ(plot::FormatNumber(1e-300), "1e-300");
  EXPECT_EQ(plot::FormatFixed(-0.001, 2), "0.00");
  EXPECT_EQ(plot::FormatFixed(359.996, 2), "360.00");
}

TEST(DrawText, StaysWithinTheWidthItSays) {
  for (const std::string text :
       {"Wy, 12.5\xC2\xB0", "i", "a longer line of text (share of white)"}) {
    cv::Mat3b page = plot::Page(600, 60);
    plot::DrawText(page, text, {50, 30}, 13, plot::Align::kLeft);
    cv::Mat1b ink;
    cv::cvtColor(page, ink, cv::COLOR_RGB2GRAY);
    const cv::Rect box = cv::boundingRect(ink < 200);
    EXPECT_GE(box.x, 50);
    EXPECT_LE(box.x + box.width, 50 + plot::TextWidth(text, 13));
    EXPECT_GT(box.width, 0);
  }
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
  EXPECT_EQ(at(10, 20), plot::DivergingColor(1.0));
  EXPECT_EQ(at(11, 20), plot::DivergingColor(-0.5));
  EXPECT_EQ(at(12, 20), plot::kUnobserved);
  EXPECT_EQ(at(13, 20), plot::DivergingColor(0.0));
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
  EXPECT_EQ(at(51, 359), plot::SequentialColor(1.0));
  EXPECT_EQ(at(50, 0), plot::SequentialColor(1.0));
  EXPECT_EQ(at(50, 1), plot::SequentialColor(1.0));
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
  EXPECT_EQ(page(229, 412), plot::DivergingColor(-0.9));
  EXPECT_EQ(page(44, 100), plot::DivergingColor(-0.9));
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
