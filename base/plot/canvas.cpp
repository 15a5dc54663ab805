#include "base/plot/canvas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace turnlight::plot {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontCapitals = 21.0;  // height of capitals at scale 1
constexpr int kOver = 4;                // text is drawn this much larger and reduced
constexpr int kShift = 4;               // fractional bits of coordinates in OpenCV's drawing
const std::string kDegree = "\xC2\xB0";

cv::Scalar ToScalar(const cv::Vec3b& colour) {
  return {double(colour[0]), double(colour[1]), double(colour[2])};
}

cv::Point ToFixed(cv::Point2d point) {
  // Far outside is as good as anywhere outside, and must not overflow.
  const auto fixed = [](double x) {
    return static_cast<int>(std::lround(std::clamp(x, -2e4, 2e4) * (1 << kShift)));
  };
  return {fixed(point.x), fixed(point.y)};
}

// Text cut into words and degree signs: the font lacks the sign and its spaces are too wide.
std::vector<std::string> CutText(const std::string& text) {
  std::vector<std::string> parts;
  std::string word;
  const auto end_word = [&] {
    if (!word.empty()) parts.push_back(std::exchange(word, ""));
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == ' ') {
      end_word();
      parts.push_back(" ");
    } else if (text.compare(i, kDegree.size(), kDegree) == 0) {
      end_word();
      parts.push_back(kDegree);
      i += kDegree.size() - 1;
    } else {
      word += text[i];
    }
  }
  end_word();
  return parts;
}

// The text as a share of ink per pixel, its capitals' middle in the middle row.
cv::Mat1b InkOfText(const std::string& text, double height) {
  const double capitals = height * kOver;
  const double scale = capitals / kFontCapitals;
  const int thickness = std::max(1, static_cast<int>(std::lround(0.13 * capitals)));
  const double ring = 0.17 * capitals;
  const auto advance = [&](const std::string& part) {
    if (part == " ") return 0.5 * capitals;
    if (part == kDegree) return 3.4 * ring;
    return double(cv::getTextSize(part, kFont, scale, thickness, nullptr).width);
  };
  const std::vector<std::string> parts = CutText(text);
  double width = 2.0 * thickness;
  for (const std::string& part : parts) width += advance(part);
  const int columns = static_cast<int>(std::ceil(width / kOver));
  const int half_rows = static_cast<int>(std::ceil(height));  // room for descenders
  cv::Mat1b large(2 * half_rows * kOver, columns * kOver, uchar{0});
  const int baseline = static_cast<int>(std::lround(half_rows * kOver + 0.5 * capitals));
  double x = thickness;
  for (const std::string& part : parts) {
    if (part == kDegree) {
      cv::circle(large, ToFixed({x + 1.7 * ring, baseline - capitals + ring}),
                 static_cast<int>(std::lround(ring * (1 << kShift))), 255, thickness, cv::LINE_AA,
                 kShift);
    } else {
      cv::putText(large, part, {static_cast<int>(std::lround(x)), baseline}, kFont, scale, 255,
                  thickness, cv::LINE_AA);
    }
    x += advance(part);
  }
  cv::Mat1b ink;
  cv::resize(large, ink, {columns, 2 * half_rows}, 0, 0, cv::INTER_AREA);
  return ink;
}

void PrintInk(cv::Mat3b& page, const cv::Mat1b& ink, cv::Point corner, const cv::Vec3b& colour) {
  const cv::Rect inside = cv::Rect(corner, ink.size()) & cv::Rect({0, 0}, page.size());
  for (int row = inside.y; row < inside.y + inside.height; ++row) {
    for (int column = inside.x; column < inside.x + inside.width; ++column) {
      const double share = ink(row - corner.y, column - corner.x) / 255.0;
      cv::Vec3b& pixel = page(row, column);
      for (int c = 0; c < 3; ++c)
        pixel[c] = static_cast<uchar>(std::lround((1.0 - share) * pixel[c] + share * colour[c]));
    }
  }
}

constexpr int kTickLength = 5;

}  // namespace

cv::Mat3b Page(int width, int height) { return cv::Mat3b(height, width, kPaper); }

int TextWidth(const std::string& text, double height) { return InkOfText(text, height).cols; }

void DrawText(cv::Mat3b& page, const std::string& text, cv::Point2d at, double height, Align align,
              const cv::Vec3b& colour) {
  if (text.empty()) return;
  const cv::Mat1b ink = InkOfText(text, height);
  const double before = align == Align::kLeft ? 0.0 : align == Align::kCenter ? 0.5 : 1.0;
  PrintInk(page, ink,
           {static_cast<int>(std::lround(at.x - before * ink.cols)),
            static_cast<int>(std::lround(at.y - 0.5 * ink.rows))},
           colour);
}

void DrawTextUpwards(cv::Mat3b& page, const std::string& text, cv::Point2d at, double height) {
  cv::Mat1b ink;
  cv::rotate(InkOfText(text, height), ink, cv::ROTATE_90_COUNTERCLOCKWISE);
  PrintInk(page, ink,
           {static_cast<int>(std::lround(at.x - 0.5 * ink.cols)),
            static_cast<int>(std::lround(at.y - 0.5 * ink.rows))},
           kInk);
}

void DrawPath(cv::Mat3b& page, const std::vector<cv::Point2d>& points, const cv::Vec3b& colour,
              int thickness, bool closed) {
  std::vector<cv::Point> fixed;
  fixed.reserve(points.size());
  for (const cv::Point2d& point : points) fixed.push_back(ToFixed(point));
  cv::polylines(page, fixed, closed, ToScalar(colour), thickness, cv::LINE_AA, kShift);
}

void DrawDisc(cv::Mat3b& page, cv::Point2d center, double radius, const cv::Vec3b& colour) {
  cv::circle(page, ToFixed(center), static_cast<int>(std::lround(radius * (1 << kShift))),
             ToScalar(colour), cv::FILLED, cv::LINE_AA, kShift);
}

void Place(cv::Mat3b& page, const cv::Mat3b& picture, cv::Point at) {
  const cv::Rect area(at, picture.size());
  cv::rectangle(page, area + cv::Size(2, 2) - cv::Point(1, 1), ToScalar(kFaint));
  picture.copyTo(page(area));
}

void DrawTicksBelow(cv::Mat3b& page, const cv::Rect& area, const std::vector<Tick>& ticks) {
  const double bottom = area.y + area.height;
  for (const Tick& tick : ticks) {
    const double x = area.x - 0.5 + tick.at * area.width;
    DrawPath(page, {{x, bottom + 1.0}, {x, bottom + (tick.label.empty() ? 3.0 : kTickLength)}},
             kInk, 1);
    DrawText(page, tick.label, {x, bottom + 2.0 * kLabel}, kLabel, Align::kCenter);
  }
}

void DrawTicksLeft(cv::Mat3b& page, const cv::Rect& area, const std::vector<Tick>& ticks) {
  const double left = area.x - 1.0;
  for (const Tick& tick : ticks) {
    const double y = area.y - 0.5 + tick.at * area.height;
    DrawPath(page, {{left - 1.0, y}, {left - (tick.label.empty() ? 3.0 : kTickLength), y}}, kInk,
             1);
    DrawText(page, tick.label, {left - kTickLength - 3.0, y}, kLabel, Align::kRight);
  }
}

void DrawColourBar(cv::Mat3b& page, const cv::Rect& area,
                   const std::function<cv::Vec3b(double)>& colour, const std::vector<Tick>& ticks) {
  cv::Mat3b bar(area.size());
  for (int row = 0; row < bar.rows; ++row)
    bar.row(row).setTo(ToScalar(colour(1.0 - (row + 0.5) / bar.rows)));
  Place(page, bar, area.tl());
  const double right = area.x + area.width;
  for (const Tick& tick : ticks) {
    const double y = area.y - 0.5 + (1.0 - tick.at) * area.height;
    DrawPath(page, {{right + 1.0, y}, {right + kTickLength, y}}, kInk, 1);
    DrawText(page, tick.label, {right + kTickLength + 3.0, y}, kLabel, Align::kLeft);
  }
}

std::string FormatNumber(double value) {
  std::array<char, 40> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.3g", value == 0.0 ? 0.0 : value);
  std::string text = buffer.data();
  const std::size_t exponent = text.find('e');
  if (exponent == std::string::npos) return text;
  // "1e-06" to "1e-6", "1e+09" to "1e9".
  const std::string sign = text[exponent + 1] == '-' ? "-" : "";
  const std::string digits = text.substr(exponent + 2);
  return text.substr(0, exponent + 1) + sign +
         digits.substr(std::min(digits.find_first_not_of('0'), digits.size() - 1));
}

std::string FormatFixed(double value, int decimals) {
  const double unit = std::pow(10.0, -decimals);
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals,
                std::abs(value) < 0.5 * unit ? 0.0 : value);
  return text.data();
}

double RoundUp(double value) {
  if (!(value > 0.0) || !std::isfinite(value)) return 1.0;
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0})
    if (step * decade >= value * (1.0 - 1e-9)) return step * decade;
  return 10.0 * decade;
}

double RoundDown(double value) {
  const double up = RoundUp(value);
  if (up <= value * (1.0 + 1e-9)) return up;
  // From 2 times a power of ten to 1, from 5 to 2, from 10 to 5.
  const double decade = std::pow(10.0, std::floor(std::log10(up) + 1e-9));
  return std::lround(up / decade) == 5 ? 0.4 * up : 0.5 * up;
}

}  // namespace turnlight::plot
