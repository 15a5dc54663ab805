#include "base/plot/chart.h"

#include <algorithm>
#include <cmath>

namespace turnlight::plot {

void DrawTitle(cv::Mat3b& page, int left, const std::string& title) {
  DrawText(page, title, {double(left), 0.5 * kTitleHeight}, kCaption, Align::kLeft);
}

void DrawSwatch(cv::Mat3b& page, cv::Point at, const cv::Vec3b& colour, const std::string& text) {
  Place(page, cv::Mat3b(11, 11, colour), at - cv::Point(0, 5));
  DrawText(page, text, {at.x + 18.0, double(at.y)}, kLabel, Align::kLeft);
}

void DrawScaleBeside(cv::Mat3b& page, const cv::Rect& area,
                     const std::function<cv::Vec3b(double)>& colour, const std::vector<Tick>& ticks,
                     const std::string& unit) {
  DrawColourBar(page, {area.x + area.width + kMargin, area.y, kBarWidth, area.height}, colour,
                ticks);
  DrawText(page, unit, {page.cols - 0.5 * kMargin, 0.5 * kTitleHeight}, kLabel, Align::kRight);
}

void DrawOutlinedPath(cv::Mat3b& page, const std::vector<cv::Point2d>& path) {
  DrawPath(page, path, kInk, 3);
  DrawPath(page, path, kPaper, 1);
}

void DrawOutlinedText(cv::Mat3b& page, const std::string& text, cv::Point2d at, Align align) {
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x)
      DrawText(page, text, at + cv::Point2d(x, y), kCaption, align, kInk);
  DrawText(page, text, at, kCaption, align, kPaper);
}

void DrawRing(cv::Mat3b& page, cv::Point2d center, double radius) {
  std::vector<cv::Point2d> path;
  for (int i = 0; i <= 72; ++i)
    path.push_back(center +
                   radius * cv::Point2d(std::cos(i * CV_PI / 36), std::sin(i * CV_PI / 36)));
  DrawOutlinedPath(page, path);
}

double LogAxis::At(double value) const { return (high - std::log10(value)) / (high - low); }

LogAxis LogAxisAround(double low, double high) {
  const double bottom = RoundDown(low);
  return {std::log10(bottom),
          std::max(std::log10(RoundUp(high)), std::log10(RoundUp(1.5 * bottom)))};
}

std::vector<Tick> LogTicks(const LogAxis& axis) {
  const double decades = axis.high - axis.low;
  const int step = std::max(1, static_cast<int>(decades / 8.0));
  std::vector<Tick> ticks;
  for (int decade = static_cast<int>(std::floor(axis.low)); decade <= axis.high + 1e-9; ++decade) {
    for (int digit = 1; digit <= (step > 1 ? 1 : 9); ++digit) {
      const double value = digit * std::pow(10.0, decade);
      const double at = axis.At(value);
      if (!(at > -1e-9 && at < 1.0 + 1e-9)) continue;
      const bool labelled =
          digit == 1 ? decade % step == 0 : decades < 2.1 && (digit == 2 || digit == 5);
      ticks.push_back({at, labelled ? FormatNumber(value) : ""});
    }
  }
  return ticks;
}

std::vector<Tick> CountTicks(int first, int last) {
  const int span = std::max(last - first, 1);
  const int step = std::max(1, static_cast<int>(RoundUp(span / 8.0)));
  std::vector<Tick> ticks;
  for (int i = (first + step - 1) / step * step; i <= last; i += step)
    ticks.push_back({double(i - first) / span, std::to_string(i)});
  return ticks;
}

std::vector<Tick> LinearTicks(double top) {
  std::vector<Tick> ticks;
  const double step = RoundUp(top / 6.0);
  for (int i = 0; i * step <= top * (1.0 + 1e-9); ++i)
    ticks.push_back({i * step / top, FormatNumber(i * step)});
  return ticks;
}

void DrawGrid(cv::Mat3b& page, const cv::Rect& area, const std::vector<Tick>& across,
              const std::vector<Tick>& down) {
  const double left = area.x - 0.5, top = area.y - 0.5;
  for (const Tick& tick : across)
    DrawPath(page,
             {{left + tick.at * area.width, top}, {left + tick.at * area.width, top + area.height}},
             kFaint, 1);
  for (const Tick& tick : down)
    if (!tick.label.empty())
      DrawPath(
          page,
          {{left, top + tick.at * area.height}, {left + area.width, top + tick.at * area.height}},
          kFaint, 1);
}

cv::Mat3b LogCurve(const ChartText& text, const std::vector<CountedValue>& values) {
  std::vector<CountedValue> shown = values;
  std::erase_if(shown,
                [](const CountedValue& v) { return !(v.value > 0.0 && std::isfinite(v.value)); });
  constexpr int kLeft = 100;
  cv::Mat3b page = Page(760, 480);
  DrawTitle(page, kLeft, text.title);
  const cv::Rect area(kLeft, kTitleHeight, page.cols - kLeft - kMargin - 12,
                      page.rows - kTitleHeight - 66);
  int first = values.front().at, last = first;
  double low = shown.empty() ? 1.0 : shown.front().value, high = low;
  for (const CountedValue& point : shown) {
    first = std::min(first, point.at);
    last = std::max(last, point.at);
    low = std::min(low, point.value);
    high = std::max(high, point.value);
  }
  const LogAxis axis = LogAxisAround(low, high);
  const std::vector<Tick> across = CountTicks(first, last);
  const std::vector<Tick> down = LogTicks(axis);
  DrawGrid(page, area, across, down);
  Place(page, page(area).clone(), area.tl());
  DrawTicksBelow(page, area, across);
  DrawTicksLeft(page, area, down);
  DrawText(page, text.across, {area.x + 0.5 * area.width, area.y + area.height + 46.0}, kLabel,
           Align::kCenter);
  DrawTextUpwards(page, text.up, {22.0, area.y + 0.5 * area.height}, kLabel);
  std::vector<cv::Point2d> path;
  path.reserve(shown.size());
  for (const CountedValue& point : shown)
    path.emplace_back(
        area.x - 0.5 + area.width * double(point.at - first) / std::max(last - first, 1),
        area.y - 0.5 + axis.At(point.value) * area.height);
  const cv::Vec3b colour = DivergingColour(-0.9);
  DrawPath(page, path, colour, 2);
  if (path.size() <= 60)
    for (const cv::Point2d& at : path) DrawDisc(page, at, 3.5, colour);
  return page;
}

}  // namespace turnlight::plot
