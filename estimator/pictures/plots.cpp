#include "estimator/pictures/plots.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "base/angles.h"
#include "base/plot/canvas.h"

namespace turnlight::estimator::pictures {
namespace {

using Eigen::Vector3d;

const std::string kDegree = "\xC2\xB0";
constexpr int kTitleHeight = 44;  // from the page's top to a part below its title
constexpr int kBarWidth = 16;

// A swatch with its meaning, beginning at `at`.
void DrawSwatch(cv::Mat3b& page, cv::Point at, const cv::Vec3b& color, const std::string& text) {
  plot::Place(page, cv::Mat3b(11, 11, color), at - cv::Point(0, 5));
  plot::DrawText(page, text, {at.x + 18.0, double(at.y)}, plot::kLabel, plot::Align::kLeft);
}

double RootMeanSquare(const cv::Mat1f& residual, int* count) {
  double sum = 0.0;
  *count = 0;
  for (const float value : residual) {
    if (std::isnan(value)) continue;
    sum += double{value} * value;
    ++*count;
  }
  return *count > 0 ? std::sqrt(sum / *count) : 0.0;
}

// ---- The intensity map.

// Azimuth 0..360 and zenith 0..180 of a direction, in degrees.
cv::Point2d ToAngles(const Vector3d& direction) {
  const double azimuth = RadToDeg(std::atan2(direction.y(), direction.x()));
  return {azimuth < 0.0 ? azimuth + 360.0 : azimuth,
          RadToDeg(std::acos(std::clamp(direction.z(), -1.0, 1.0)))};
}

struct MapFrame {
  cv::Rect area;
  cv::Point2d ToPage(const cv::Point2d& angles_deg) const {
    return {area.x - 0.5 + angles_deg.x / 360.0 * area.width,
            area.y - 0.5 + angles_deg.y / 180.0 * area.height};
  }
};

// A light line with a dark edge: seen on any colour of the map.
void DrawMark(cv::Mat3b& page, const std::vector<cv::Point2d>& path) {
  plot::DrawPath(page, path, plot::kInk, 3);
  plot::DrawPath(page, path, plot::kPaper, 1);
}

// The circle of angular radius `radius` about a direction; cut where it leaves the map at 0 or 360.
void DrawCircleOnSphere(cv::Mat3b& page, const MapFrame& frame, const Vector3d& center,
                        double radius) {
  const Vector3d a = center.unitOrthogonal();
  const Vector3d b = center.cross(a);
  std::vector<cv::Point2d> path;
  constexpr int kSteps = 180;
  for (int i = 0; i <= kSteps; ++i) {
    const double angle = 2.0 * CV_PI * i / kSteps;
    const cv::Point2d point =
        frame.ToPage(ToAngles(std::cos(radius) * center +
                              std::sin(radius) * (std::cos(angle) * a + std::sin(angle) * b)));
    if (!path.empty() && std::abs(point.x - path.back().x) > 0.5 * frame.area.width)
      DrawMark(page, std::exchange(path, {}));
    path.push_back(point);
  }
  DrawMark(page, path);
}

constexpr double kRing = 9.0;

void DrawRing(cv::Mat3b& page, cv::Point2d at) {
  std::vector<cv::Point2d> path;
  for (int i = 0; i <= 72; ++i)
    path.push_back(at + kRing * cv::Point2d(std::cos(i * CV_PI / 36), std::sin(i * CV_PI / 36)));
  DrawMark(page, path);
}

void DrawLight(cv::Mat3b& page, const MapFrame& frame, const LightEstimate& light, int number) {
  const Vector3d& direction = light.direction_at_reference;
  const cv::Point2d at = frame.ToPage(ToAngles(direction));
  const double radius = 3.0 * light.direction_sigma;
  if (std::isfinite(radius) && RadToDeg(radius) / 180.0 * frame.area.height > 1.0)
    DrawCircleOnSphere(page, frame, direction, std::min(radius, CV_PI / 2));
  DrawRing(page, at);
  const std::string label = std::to_string(number);
  const bool near_right = at.x + kRing + 24 > frame.area.x + frame.area.width;
  const cv::Point2d text(near_right ? at.x - kRing - 5 : at.x + kRing + 5, at.y);
  const plot::Align align = near_right ? plot::Align::kRight : plot::Align::kLeft;
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x)
      plot::DrawText(page, label, text + cv::Point2d(x, y), plot::kCaption, align, plot::kInk);
  plot::DrawText(page, label, text, plot::kCaption, align, plot::kPaper);
}

std::string DescribeLight(const LightEstimate& light, int number) {
  const cv::Point2d angles = ToAngles(light.direction_at_reference);
  std::string text = std::to_string(number) + ":  azimuth " + plot::FormatFixed(angles.x, 2) +
                     kDegree + ",  zenith " + plot::FormatFixed(angles.y, 2) + kDegree;
  if (std::isfinite(light.direction_sigma))
    text += ",  3 sigma " + plot::FormatNumber(RadToDeg(3.0 * light.direction_sigma)) + kDegree;
  return text + ",  intensity " + plot::FormatNumber(light.light.intensity);
}

// The map's value at a cell that may lie beyond a pole (on the other side of it) or beyond 0 or 360
// degrees of azimuth, by less than the map's size.
float ValueAcross(const cv::Mat1f& map, int row, int column) {
  const bool beyond = row < 0 || row >= map.rows;
  if (row < 0) row = -1 - row;
  if (row >= map.rows) row = 2 * map.rows - 1 - row;
  const int turned = column + map.cols + (beyond ? map.cols / 2 : 0);
  return map(row, turned % map.cols);
}

// The map as it is drawn: samples of a coarse picture leave gaps of a cell or two, which would hide
// the map behind a moire. A cell without a value takes the mean of what lies within 3 degrees on
// the sphere if that surrounds it, that is, if three of its four quadrants have a value; so the
// border of what was seen stays where it is.
cv::Mat1f CloseGaps(const cv::Mat1f& map) {
  constexpr double kReachDeg = 3.0;
  const int rows = map.rows, columns = map.cols;
  // In cells: bounded, for a fine map has no gaps that are worth the search.
  const int reach = std::min({static_cast<int>(std::lround(kReachDeg * rows / 180.0)), 4, rows});
  cv::Mat1f closed = map.clone();
  for (int row = 0; row < rows; ++row) {
    const double sine = std::sin(CV_PI * (row + 0.5) / rows);
    const int across = std::min(static_cast<int>(std::lround(kReachDeg * columns / 360.0 / sine)),
                                (columns - 1) / 2);
    for (int column = 0; column < columns; ++column) {
      if (!std::isnan(map(row, column))) continue;
      double sum = 0.0;
      int count = 0;
      bool quadrants[2][2] = {};
      for (int y = -reach; y <= reach; ++y) {
        for (int x = -across; x <= across; ++x) {
          const float value = ValueAcross(map, row + y, column + x);
          if (std::isnan(value)) continue;
          sum += value;
          ++count;
          if (y <= 0 && x <= 0) quadrants[0][0] = true;
          if (y <= 0 && x >= 0) quadrants[0][1] = true;
          if (y >= 0 && x <= 0) quadrants[1][0] = true;
          if (y >= 0 && x >= 0) quadrants[1][1] = true;
        }
      }
      const int around = quadrants[0][0] + quadrants[0][1] + quadrants[1][0] + quadrants[1][1];
      if (around >= 3) closed(row, column) = static_cast<float>(sum / count);
    }
  }
  return closed;
}

// ---- The plot.

struct LogAxis {
  double low = 0.0, high = 0.0;  // decimal logarithms
  double At(double value) const { return (high - std::log10(value)) / (high - low); }
};

// From 1, 2 or 5 times a power of ten below the values to one above them, at least a factor of 2.
LogAxis AxisAround(double low, double high) {
  const double bottom = plot::RoundDown(low);
  return {std::log10(bottom),
          std::max(std::log10(plot::RoundUp(high)), std::log10(plot::RoundUp(1.5 * bottom)))};
}

std::vector<plot::Tick> LogTicks(const LogAxis& axis) {
  const double decades = axis.high - axis.low;
  const int step = std::max(1, static_cast<int>(decades / 8.0));
  std::vector<plot::Tick> ticks;
  for (int decade = static_cast<int>(std::floor(axis.low)); decade <= axis.high + 1e-9; ++decade) {
    for (int digit = 1; digit <= (step > 1 ? 1 : 9); ++digit) {
      const double value = digit * std::pow(10.0, decade);
      const double at = axis.At(value);
      if (!(at > -1e-9 && at < 1.0 + 1e-9)) continue;
      const bool labelled =
          digit == 1 ? decade % step == 0 : decades < 2.1 && (digit == 2 || digit == 5);
      ticks.push_back({at, labelled ? plot::FormatNumber(value) : ""});
    }
  }
  return ticks;
}

std::vector<plot::Tick> IterationTicks(int first, int last) {
  const int span = std::max(last - first, 1);
  const int step = std::max(1, static_cast<int>(plot::RoundUp(span / 8.0)));
  std::vector<plot::Tick> ticks;
  for (int i = (first + step - 1) / step * step; i <= last; i += step)
    ticks.push_back({double(i - first) / span, std::to_string(i)});
  return ticks;
}

void DrawGrid(cv::Mat3b& page, const cv::Rect& area, const std::vector<plot::Tick>& across,
              const std::vector<plot::Tick>& down) {
  const double left = area.x - 0.5, top = area.y - 0.5;
  for (const plot::Tick& tick : across)
    plot::DrawPath(
        page,
        {{left + tick.at * area.width, top}, {left + tick.at * area.width, top + area.height}},
        plot::kFaint, 1);
  for (const plot::Tick& tick : down)
    if (!tick.label.empty())
      plot::DrawPath(
          page,
          {{left, top + tick.at * area.height}, {left + area.width, top + tick.at * area.height}},
          plot::kFaint, 1);
}

}  // namespace

double ResidualRange(const std::vector<cv::Mat1f>& residuals) {
  std::vector<float> sizes;
  for (const cv::Mat1f& residual : residuals)
    for (const float value : residual) sizes.push_back(std::abs(value));
  return plot::RoundUp(plot::Percentile(std::move(sizes), 0.995));
}

cv::Mat3b ResidualPicture(const cv::Mat1f& residual, double range, int enlarge,
                          const std::string& title) {
  cv::Mat3b colors(residual.size());
  for (int row = 0; row < residual.rows; ++row)
    for (int column = 0; column < residual.cols; ++column)
      colors(row, column) = plot::DivergingColor(residual(row, column) / range);
  cv::resize(colors, colors, {}, enlarge, enlarge, cv::INTER_NEAREST);

  constexpr int kBarLabels = 76;
  const cv::Rect area({plot::kMargin, kTitleHeight}, colors.size());
  cv::Mat3b page = plot::Page(area.width + 3 * plot::kMargin + kBarWidth + kBarLabels,
                              area.height + kTitleHeight + plot::kMargin + 24);
  plot::DrawText(page, title, {plot::kMargin, 0.5 * kTitleHeight}, plot::kCaption,
                 plot::Align::kLeft);
  plot::Place(page, colors, area.tl());
  const auto label = [&](double share) {
    const std::string number = plot::FormatNumber(share * range);
    return share > 0.0 ? "+" + number : number;
  };
  const cv::Rect bar(area.x + area.width + plot::kMargin, area.y, kBarWidth, area.height);
  plot::DrawColorBar(page, bar, [](double t) { return plot::DivergingColor(2.0 * t - 1.0); },
                     {{0.0, label(-1.0)},
                      {0.25, label(-0.5)},
                      {0.5, label(0.0)},
                      {0.75, label(0.5)},
                      {1.0, label(1.0)}});
  plot::DrawText(page, "share of white", {page.cols - 0.5 * plot::kMargin, 0.5 * kTitleHeight},
                 plot::kLabel, plot::Align::kRight);
  int observed = 0;
  const double rms = RootMeanSquare(residual, &observed);
  const int below = area.y + area.height + 24;
  plot::DrawText(page,
                 observed > 0 ? "rms " + plot::FormatNumber(rms) + " over " +
                                    std::to_string(observed) + " pixels"
                              : "nothing observed",
                 {plot::kMargin, double(below)}, plot::kLabel, plot::Align::kLeft);
  DrawSwatch(page, {area.x + area.width - 110, below}, plot::kUnobserved, "not observed");
  return page;
}

cv::Mat3b IntensityPicture(const observe::IntensityMap& map,
                           const std::vector<LightEstimate>& lights) {
  const cv::Mat1f intensity = CloseGaps(map.intensity);
  const double brightest = plot::Percentile({intensity.begin(), intensity.end()}, 1.0);
  const double top = brightest > 0.0 ? brightest : 1.0;
  cv::Mat3b colors(intensity.size());
  for (int row = 0; row < colors.rows; ++row)
    for (int column = 0; column < colors.cols; ++column)
      colors(row, column) = plot::SequentialColor(intensity(row, column) / top);
  const cv::Size size(1080, 540);
  const bool fits = size.width % colors.cols == 0 && size.height % colors.rows == 0;
  cv::resize(colors, colors, size, 0, 0, fits ? cv::INTER_NEAREST : cv::INTER_LINEAR);

  constexpr int kLeft = 84, kBelow = 60, kBarLabels = 60, kLine = 22;
  const MapFrame frame{{{kLeft, kTitleHeight}, colors.size()}};
  const cv::Rect& area = frame.area;
  const int lines = static_cast<int>(lights.size());
  cv::Mat3b page = plot::Page(kLeft + area.width + 2 * plot::kMargin + kBarWidth + kBarLabels,
                              area.y + area.height + kBelow + lines * kLine + plot::kMargin);
  plot::DrawText(page, "Intensity by reflected direction, and the lights found",
                 {kLeft, 0.5 * kTitleHeight}, plot::kCaption, plot::Align::kLeft);
  plot::Place(page, colors, area.tl());
  for (int i = 0; i < lines; ++i) DrawLight(page, frame, lights[i], i + 1);

  std::vector<plot::Tick> across, down;
  for (int deg = 0; deg <= 360; deg += 30)
    across.push_back({deg / 360.0, std::to_string(deg) + kDegree});
  for (int deg = 0; deg <= 180; deg += 30)
    down.push_back({deg / 180.0, std::to_string(deg) + kDegree});
  plot::DrawTicksBelow(page, area, across);
  plot::DrawTicksLeft(page, area, down);
  plot::DrawText(page, "azimuth", {area.x + 0.5 * area.width, area.y + area.height + 44.0},
                 plot::kLabel, plot::Align::kCenter);
  plot::DrawTextUpwards(page, "zenith angle", {22.0, area.y + 0.5 * area.height}, plot::kLabel);
  const cv::Rect bar(area.x + area.width + plot::kMargin, area.y, kBarWidth, area.height);
  std::vector<plot::Tick> ticks;
  const double step = plot::RoundUp(top / 6.0);
  for (int i = 0; i * step <= top * (1.0 + 1e-9); ++i)
    ticks.push_back({i * step / top, plot::FormatNumber(i * step)});
  plot::DrawColorBar(page, bar, plot::SequentialColor, ticks);
  plot::DrawText(page, "share of white", {page.cols - 0.5 * plot::kMargin, 0.5 * kTitleHeight},
                 plot::kLabel, plot::Align::kRight);
  DrawSwatch(page, {area.x + area.width - 110, area.y + area.height + 44}, plot::kUnseen,
             "not seen");
  for (int i = 0; i < lines; ++i)
    plot::DrawText(page, DescribeLight(lights[i], i + 1),
                   {kLeft, area.y + area.height + kBelow + (i + 0.5) * kLine}, plot::kLabel,
                   plot::Align::kLeft);
  return page;
}

cv::Mat3b ConvergencePicture(const std::vector<IterationRecord>& history) {
  std::vector<IterationRecord> records = history;
  std::erase_if(records,
                [](const IterationRecord& r) { return !(r.rms > 0.0 && std::isfinite(r.rms)); });
  constexpr int kLeft = 100;
  cv::Mat3b page = plot::Page(760, 480);
  plot::DrawText(page, "Residual by iteration", {kLeft, 0.5 * kTitleHeight}, plot::kCaption,
                 plot::Align::kLeft);
  const cv::Rect area(kLeft, kTitleHeight, page.cols - kLeft - plot::kMargin - 12,
                      page.rows - kTitleHeight - 66);
  int first = history.front().iteration, last = first;
  double low = records.empty() ? 1.0 : records.front().rms, high = low;
  for (const IterationRecord& record : records) {
    first = std::min(first, record.iteration);
    last = std::max(last, record.iteration);
    low = std::min(low, record.rms);
    high = std::max(high, record.rms);
  }
  const LogAxis axis = AxisAround(low, high);
  const std::vector<plot::Tick> across = IterationTicks(first, last);
  const std::vector<plot::Tick> down = LogTicks(axis);
  DrawGrid(page, area, across, down);
  plot::Place(page, page(area).clone(), area.tl());
  plot::DrawTicksBelow(page, area, across);
  plot::DrawTicksLeft(page, area, down);
  plot::DrawText(page, "iteration", {area.x + 0.5 * area.width, area.y + area.height + 46.0},
                 plot::kLabel, plot::Align::kCenter);
  plot::DrawTextUpwards(page, "residual rms (share of white)", {22.0, area.y + 0.5 * area.height},
                        plot::kLabel);
  std::vector<cv::Point2d> path;
  path.reserve(records.size());
  for (const IterationRecord& record : records)
    path.emplace_back(
        area.x - 0.5 + area.width * double(record.iteration - first) / std::max(last - first, 1),
        area.y - 0.5 + axis.At(record.rms) * area.height);
  const cv::Vec3b color = plot::DivergingColor(-0.9);
  plot::DrawPath(page, path, color, 2);
  if (path.size() <= 60)
    for (const cv::Point2d& point : path) plot::DrawDisc(page, point, 3.5, color);
  return page;
}

}  // namespace turnlight::estimator::pictures
