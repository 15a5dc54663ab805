#include "base/plot/sky_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "base/angles.h"
#include "base/plot/chart.h"
#include "base/statistics.h"

namespace turnlight::plot {
namespace {

using Eigen::Vector3d;

const std::string kDegreeSign = "\xC2\xB0";

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
      DrawOutlinedPath(page, std::exchange(path, {}));
    path.push_back(point);
  }
  DrawOutlinedPath(page, path);
}

constexpr double kRing = 9.0;  // radius, pixels

void DrawMark(cv::Mat3b& page, const MapFrame& frame, const SkyMark& mark) {
  const cv::Point2d at = frame.ToPage(ToAngles(mark.direction));
  if (std::isfinite(mark.radius) && RadToDeg(mark.radius) / 180.0 * frame.area.height > 1.0)
    DrawCircleOnSphere(page, frame, mark.direction, std::min(mark.radius, CV_PI / 2));
  DrawRing(page, at, kRing);
  const bool near_right = at.x + kRing + 24 > frame.area.x + frame.area.width;
  const cv::Point2d text(near_right ? at.x - kRing - 5 : at.x + kRing + 5, at.y);
  const Align align = near_right ? Align::kRight : Align::kLeft;
  DrawOutlinedText(page, mark.label, text, align);
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

}  // namespace

std::string SkyAngles(const Vector3d& direction) {
  const cv::Point2d angles = ToAngles(direction);
  return "azimuth " + FormatFixed(angles.x, 2) + kDegreeSign + ",  zenith " +
         FormatFixed(angles.y, 2) + kDegreeSign;
}

cv::Mat3b SkyMap(const cv::Mat1f& map, const SkyText& text, const std::vector<SkyMark>& marks) {
  const cv::Mat1f intensity = CloseGaps(map);
  const double brightest = NearestRank<float>({intensity.begin(), intensity.end()}, 1.0);
  const double top = brightest > 0.0 ? brightest : 1.0;
  cv::Mat3b colours(intensity.size());
  for (int row = 0; row < colours.rows; ++row)
    for (int column = 0; column < colours.cols; ++column)
      colours(row, column) = SequentialColour(intensity(row, column) / top);
  const cv::Size size(1080, 540);
  const bool fits = size.width % colours.cols == 0 && size.height % colours.rows == 0;
  cv::resize(colours, colours, size, 0, 0, fits ? cv::INTER_NEAREST : cv::INTER_LINEAR);

  constexpr int kLeft = 84, kBelow = 60, kBarLabels = 60, kLine = 22;
  const MapFrame frame{{{kLeft, kTitleHeight}, colours.size()}};
  const cv::Rect& area = frame.area;
  const int lines = static_cast<int>(marks.size());
  cv::Mat3b page = Page(kLeft + area.width + 2 * kMargin + kBarWidth + kBarLabels,
                        area.y + area.height + kBelow + lines * kLine + kMargin);
  DrawTitle(page, kLeft, text.title);
  Place(page, colours, area.tl());
  for (const SkyMark& mark : marks) DrawMark(page, frame, mark);

  std::vector<Tick> across, down;
  for (int deg = 0; deg <= 360; deg += 30)
    across.push_back({deg / 360.0, std::to_string(deg) + kDegreeSign});
  for (int deg = 0; deg <= 180; deg += 30)
    down.push_back({deg / 180.0, std::to_string(deg) + kDegreeSign});
  DrawTicksBelow(page, area, across);
  DrawTicksLeft(page, area, down);
  DrawText(page, "azimuth", {area.x + 0.5 * area.width, area.y + area.height + 44.0}, kLabel,
           Align::kCenter);
  DrawTextUpwards(page, "zenith angle", {22.0, area.y + 0.5 * area.height}, kLabel);
  DrawScaleBeside(page, area, SequentialColour, LinearTicks(top), text.unit);
  DrawSwatch(page, {area.x + area.width - 110, area.y + area.height + 44}, kUnseen, "not seen");
  for (int i = 0; i < lines; ++i)
    DrawText(page, marks[i].words, {kLeft, area.y + area.height + kBelow + (i + 0.5) * kLine},
             kLabel, Align::kLeft);
  return page;
}

}  // namespace turnlight::plot
