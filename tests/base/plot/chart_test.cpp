// Proves that axes begin and end at round numbers around their values, that ticks are where their
// numbers are, that a curve runs where its axes say, and that strange values are drawn without text
// cut at the page's edge. Does not prove that charts please: that takes eyes.
#include "base/plot/chart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/base/plot/clear_edge.h"

namespace turnlight::plot {
namespace {

TEST(LogAxis, EndsAtRoundNumbersAroundTheValues) {
  const LogAxis axis = LogAxisAround(0.0013, 0.34);
  EXPECT_NEAR(axis.At(0.5), 0.0, 1e-12);
  EXPECT_NEAR(axis.At(0.001), 1.0, 1e-12);
  // One value: at least a factor of 2.
  const LogAxis narrow = LogAxisAround(0.2, 0.2);
  EXPECT_GE(std::pow(10.0, narrow.high - narrow.low), 2.0 - 1e-12);
}

TEST(LogTicks, StandWhereTheirNumbersAre) {
  const LogAxis axis = LogAxisAround(0.001, 0.1);
  int labelled = 0;
  for (const Tick& tick : LogTicks(axis)) {
    if (tick.label.empty()) continue;
    ++labelled;
    EXPECT_NEAR(tick.at, axis.At(std::stod(tick.label)), 1e-9) << tick.label;
  }
  EXPECT_GE(labelled, 3);
  const std::vector<Tick> wide = LogTicks(LogAxisAround(1e-300, 1e300));
  EXPECT_LE(std::count_if(wide.begin(), wide.end(), [](const Tick& t) { return !t.label.empty(); }),
            10);
}

TEST(CountTicks, AreWholeAndNotMany) {
  for (const int last : {0, 1, 7, 40, 99999}) {
    const std::vector<Tick> ticks = CountTicks(0, last);
    EXPECT_EQ(ticks.front().label, "0");
    EXPECT_LE(ticks.size(), 10u);
    for (const Tick& tick : ticks)
      EXPECT_NEAR(tick.at, std::stod(tick.label) / std::max(last, 1), 1e-12);
  }
  EXPECT_EQ(CountTicks(5, 25).front().label, "5");
}

TEST(LinearTicks, AreAtMostSevenRoundNumbers) {
  for (const double top : {1.0, 0.77, 0.031, 6e10}) {
    const std::vector<Tick> ticks = LinearTicks(top);
    EXPECT_EQ(ticks.front().label, "0");
    EXPECT_LE(ticks.size(), 7u);
    EXPECT_LE(ticks.back().at, 1.0 + 1e-9);
    EXPECT_NEAR(ticks.back().at, std::stod(ticks.back().label) / top, 1e-9);
  }
}

TEST(DrawScaleBeside, StandsRightOfTheArea) {
  cv::Mat3b page = Page(300, 200);
  const cv::Rect area(kMargin, kTitleHeight, 100, 100);
  DrawScaleBeside(page, area, SequentialColour, LinearTicks(1.0), "unit");
  const int x = area.x + area.width + kMargin + kBarWidth / 2;
  EXPECT_GT(cv::norm(page(area.y + 2, x)), cv::norm(page(area.y + 97, x)));
  EXPECT_EQ(page(area.y + 50, area.x + area.width + kMargin - 4), kPaper);
}

TEST(LogCurve, RunsWhereItsAxesSay) {
  const cv::Mat3b page = LogCurve({"t", "a", "u"}, {{0, 0.1}, {1, 0.01}, {2, 0.001}});
  ExpectClearEdge(page);
  // A straight line in logarithms: the middle point is at the middle of the area, 100..724
  // by 44..414.
  EXPECT_EQ(page(229, 412), DivergingColour(-0.9));
  EXPECT_EQ(page(44, 100), DivergingColour(-0.9));
}

TEST(LogCurve, StrangeValuesAreDrawn) {
  const std::vector<std::vector<CountedValue>> curves{
      {{0, 0.0}}, {{3, NAN}, {4, HUGE_VAL}}, {{0, 1e-300}, {1, 1e300}}, {{0, 0.3}, {100000, 0.1}}};
  for (const auto& curve : curves) ExpectClearEdge(LogCurve({"title", "across", "up"}, curve));
}

}  // namespace
}  // namespace turnlight::plot
