// Proves that the colour maps are symmetric and monotone in lightness and limited to their ends,
// and that display encodes as sRGB. Does not prove that they please.
#include "base/plot/colours.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/base/plot/lightness.h"

namespace turnlight::plot {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

TEST(DivergingColour, IsSymmetricInLightnessFromWhiteToBlueAndRed) {
  EXPECT_EQ(DivergingColour(0.0), cv::Vec3b(255, 255, 255));
  double previous = 101.0;
  for (double t = 0.0; t <= 1.0; t += 0.05) {
    const cv::Vec3b red = DivergingColour(t), blue = DivergingColour(-t);
    EXPECT_NEAR(Lightness(red), Lightness(blue), 4.0) << t;
    EXPECT_LT(Lightness(red), previous);
    previous = Lightness(red);
    if (t > 0.1) {
      EXPECT_GT(red[0], red[2] + 10) << t;
      EXPECT_GT(blue[2], blue[0] + 10) << t;
    }
  }
  EXPECT_EQ(DivergingColour(1.0), DivergingColour(1e30));
  EXPECT_EQ(DivergingColour(-1.0), DivergingColour(-kInf));
  EXPECT_EQ(DivergingColour(kNan), kUnobserved);
}

TEST(SequentialColour, GetsLighter) {
  for (double t = 0.0; t < 0.95; t += 0.05)
    EXPECT_LT(Lightness(SequentialColour(t)), Lightness(SequentialColour(t + 0.05)));
  EXPECT_EQ(SequentialColour(-3.0), SequentialColour(0.0));
  EXPECT_EQ(SequentialColour(kInf), SequentialColour(1.0));
  EXPECT_EQ(SequentialColour(kNan), kUnseen);
}

TEST(ToDisplay, EncodesAsSrgb) {
  cv::Mat3f radiance(1, 4, cv::Vec3f(0.5f, 0.0f, 1.0f));
  radiance(0, 1) = {-1.0f, 7.0f, kNan};
  radiance(0, 2) = {0.001f, kInf, -kInf};
  const cv::Mat3b shown = ToDisplay(radiance, 1.0, 1);
  EXPECT_EQ(shown(0, 0), cv::Vec3b(188, 0, 255));
  EXPECT_EQ(shown(0, 1), cv::Vec3b(0, 255, 0));
  EXPECT_EQ(shown(0, 2), cv::Vec3b(3, 255, 0));
  EXPECT_EQ(ToDisplay(radiance, 0.5, 3).size(), cv::Size(12, 3));
}

}  // namespace
}  // namespace turnlight::plot
