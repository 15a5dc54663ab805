// Drawing on a page: text, lines, axes, colour bars, in one restrained style. Colours are R, G, B,
// coordinates are pixels of the page with (0, 0) the centre of its top-left one.
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "base/plot/colours.h"

namespace turnlight::plot {

inline constexpr int kMargin = 24;        // around and between the parts of a page
inline constexpr double kCaption = 13.0;  // height of capitals, pixels
inline constexpr double kLabel = 10.0;

enum class Align { kLeft, kCenter, kRight };

// A page of paper.
cv::Mat3b Page(int width, int height);

// Width in pixels that DrawText needs. The character U+00B0 (degree, in UTF-8) is drawn as a ring.
int TextWidth(const std::string& text, double height);

// Draws one line of text whose capitals are `height` pixels high; `at` is half way up them, at the
// left, centre or right end. Smooth at any size.
void DrawText(cv::Mat3b& page, const std::string& text, cv::Point2d at, double height, Align align,
              const cv::Vec3b& colour = kInk);
// The same turned by 90 degrees to read upwards, centred.
void DrawTextUpwards(cv::Mat3b& page, const std::string& text, cv::Point2d at, double height);

// A smooth line through the points, which may lie between pixels.
void DrawPath(cv::Mat3b& page, const std::vector<cv::Point2d>& points, const cv::Vec3b& colour,
              int thickness, bool closed = false);
void DrawDisc(cv::Mat3b& page, cv::Point2d center, double radius, const cv::Vec3b& colour);

// Copies the picture to the page with its top-left pixel at `at`, and a thin frame around it.
void Place(cv::Mat3b& page, const cv::Mat3b& picture, cv::Point at);

struct Tick {
  double at = 0.0;    // 0..1 along the axis
  std::string label;  // empty: a minor tick
};

// Ticks and labels below `area` (0 left, 1 right) or left of it (0 top, 1 bottom).
void DrawTicksBelow(cv::Mat3b& page, const cv::Rect& area, const std::vector<Tick>& ticks);
void DrawTicksLeft(cv::Mat3b& page, const cv::Rect& area, const std::vector<Tick>& ticks);

// An upright colour bar: colour(0) at the bottom, colour(1) at the top; labels at its right.
void DrawColourBar(cv::Mat3b& page, const cv::Rect& area,
                   const std::function<cv::Vec3b(double)>& colour, const std::vector<Tick>& ticks);

// A number for a label, three digits: "0.05", "1e-6", never "-0".
std::string FormatNumber(double value);
// With a fixed number of decimals, never "-0.0".
std::string FormatFixed(double value, int decimals);

// The smallest of 1, 2, 5 times a power of ten that is not below value; 1 if value is not positive
// and finite.
double RoundUp(double value);
// The largest of them that is not above value, which is positive and finite.
double RoundDown(double value);

}  // namespace turnlight::plot
