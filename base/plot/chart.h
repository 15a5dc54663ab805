// Parts that charts share: titles, axes with round numbers, grids, scales, marks; and charts of
// curves as whole pages.
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "base/plot/canvas.h"

namespace turnlight::plot {

inline constexpr int kTitleHeight = 44;  // from the page's top to a part below its title
inline constexpr int kBarWidth = 16;     // of a colour bar

// A title at the top of the page, beginning at column `left`.
void DrawTitle(cv::Mat3b& page, int left, const std::string& title);

// A swatch with its meaning, beginning at `at`.
void DrawSwatch(cv::Mat3b& page, cv::Point at, const cv::Vec3b& colour, const std::string& text);

// A colour bar as high as `area`, a margin to its right, and at the page's top right what its
// numbers are.
void DrawScaleBeside(cv::Mat3b& page, const cv::Rect& area,
                     const std::function<cv::Vec3b(double)>& colour, const std::vector<Tick>& ticks,
                     const std::string& unit);

// A light line, or text, with a dark edge: seen on any colour of a map.
void DrawOutlinedPath(cv::Mat3b& page, const std::vector<cv::Point2d>& path);
void DrawOutlinedText(cv::Mat3b& page, const std::string& text, cv::Point2d at, Align align);
void DrawRing(cv::Mat3b& page, cv::Point2d center, double radius);

struct LogAxis {
  double low = 0.0, high = 0.0;   // decimal logarithms
  double At(double value) const;  // 0 at the top, 1 at the bottom, as Tick::at left of an area
};

// From 1, 2 or 5 times a power of ten below the values (positive, finite) to one above them, at
// least a factor of 2.
LogAxis LogAxisAround(double low, double high);
// At each power of ten, labelled; between them minor ones where there is room.
std::vector<Tick> LogTicks(const LogAxis& axis);
// Along an axis from first to last, whole numbers, in steps of 1, 2 or 5 times a power of ten.
std::vector<Tick> CountTicks(int first, int last);
// Along an axis from 0 to top (positive): at most seven round numbers.
std::vector<Tick> LinearTicks(double top);

// Lines through the labelled ticks left of the area and all ticks below it.
void DrawGrid(cv::Mat3b& page, const cv::Rect& area, const std::vector<Tick>& across,
              const std::vector<Tick>& down);

struct ChartText {
  std::string title, across, up;  // of the page, the axis below and the axis at the left
};
struct CountedValue {
  int at = 0;
  double value = 0.0;
};
// A page with one curve of values by a whole number, logarithmic upwards. Values that are not
// positive and finite are left out; there is at least one.
cv::Mat3b LogCurve(const ChartText& text, const std::vector<CountedValue>& values);

}  // namespace turnlight::plot
