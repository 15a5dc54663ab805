// Proves that numbers for labels are round and short, and that text stays within the width it says.
// Does not prove that it is legible: that takes eyes.
#include "base/plot/canvas.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace turnlight::plot {
namespace {

TEST(Canvas, NumbersForLabels) {
  EXPECT_EQ(RoundUp(0.0003), 0.0005);
  EXPECT_EQ(RoundUp(0.1), 0.1);
  EXPECT_EQ(RoundUp(7.0), 10.0);
  EXPECT_EQ(RoundUp(0.0), 1.0);
  EXPECT_EQ(RoundUp(HUGE_VAL), 1.0);
  EXPECT_DOUBLE_EQ(RoundDown(0.0003), 0.0002);
  EXPECT_DOUBLE_EQ(RoundDown(0.1), 0.1);
  EXPECT_DOUBLE_EQ(RoundDown(7.0), 5.0);
  EXPECT_DOUBLE_EQ(RoundDown(0.19), 0.1);
  EXPECT_EQ(FormatNumber(-0.0), "0");
  EXPECT_EQ(FormatNumber(0.00123456), "0.00123");
  EXPECT_EQ(FormatNumber(-1.5e-6), "-1.5e-6");
  EXPECT_EQ(FormatNumber(2e10), "2e10");
  EXPECT_EQ(FormatNumber(1e-300), "1e-300");
  EXPECT_EQ(FormatFixed(-0.001, 2), "0.00");
  EXPECT_EQ(FormatFixed(359.996, 2), "360.00");
}

TEST(DrawText, StaysWithinTheWidthItSays) {
  for (const std::string text :
       {"Wy, 12.5\xC2\xB0", "i", "a longer line of text (share of white)"}) {
    cv::Mat3b page = Page(600, 60);
    DrawText(page, text, {50, 30}, 13, Align::kLeft);
    cv::Mat1b ink;
    cv::cvtColor(page, ink, cv::COLOR_RGB2GRAY);
    const cv::Rect box = cv::boundingRect(ink < 200);
    EXPECT_GE(box.x, 50);
    EXPECT_LE(box.x + box.width, 50 + TextWidth(text, 13));
    EXPECT_GT(box.width, 0);
  }
}

}  // namespace
}  // namespace turnlight::plot
