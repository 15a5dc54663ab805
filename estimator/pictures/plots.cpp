#include "estimator/pictures/plots.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "base/angles.h"
#include "base/plot/chart.h"
#include "base/statistics.h"

namespace turnlight::estimator::pictures {
namespace {

using Eigen::Vector3d;

const std::string kDegree = "\xC2\xB0";
const std::string kUnit = "share of white";

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
      plot::DrawOutlinedPath(page, std::exchange(path, {}));
    path.push_back(point);
  }
  plot::DrawOutlinedPath(page, path);
}

constexpr double kRing = 9.0;  // radius, pixels

void DrawLight(cv::Mat3b& page, const MapFrame& frame, const LightEstimate& light, int number) {
  const Vector3d& direction = light.direction_at_reference;
  const cv::Point2d at = frame.ToPage(ToAngles(direction));
  const double radius = 3.0 * light.direction_sigma;
  if (std::isfinite(radius) && RadToDeg(radius) / 180.0 * frame.area.height > 1.0)
    DrawCircleOnSphere(page, frame, direction, std::min(radius, CV_PI / 2));
  plot::DrawRing(page, at, kRing);
  const std::string label = std::to_string(number);
  const bool near_right = at.x + kRing + 24 > frame.area.x + frame.area.width;
  const cv::Point2d text(near_right ? at.x - kRing - 5 : at.x + kRing + 5, at.y);
  const plot::Align align = near_right ? plot::Align::kRight : plot::Align::kLeft;
  plot::DrawOutlinedText(page, label, text, align);
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

}  // namespace

double ResidualRange(const std::vector<cv::Mat1f>& residuals) {
  std::vector<float> sizes;
  for (const cv::Mat1f& residual : residuals)
    for (const float value : residual) sizes.push_back(std::abs(value));
  return plot::RoundUp(NearestRank(std::move(sizes), 0.995));
}

cv::Mat3b ResidualPicture(const cv::Mat1f& residual, double range, int enlarge,
                          const std::string& title) {
  cv::Mat3b colours(residual.size());
  for (int row = 0; row < residual.rows; ++row)
    for (int column = 0; column < residual.cols; ++column)
      colours(row, column) = plot::DivergingColour(residual(row, column) / range);
  cv::resize(colours, colours, {}, enlarge, enlarge, cv::INTER_NEAREST);

  constexpr int kBarLabels = 76;
  const cv::Rect area({plot::kMargin, plot::kTitleHeight}, colours.size());
  cv::Mat3b page = plot::Page(area.width + 3 * plot::kMargin + plot::kBarWidth + kBarLabels,
                              area.height + plot::kTitleHeight + plot::kMargin + 24);
  plot::DrawTitle(page, plot::kMargin, title);
  plot::Place(page, colours, area.tl());
  const auto label = [&](double share) {
    const std::string number = plot::FormatNumber(share * range);
    return share > 0.0 ? "+" + number : number;
  };
  plot::DrawScaleBeside(
      page, area, [](double t) { return plot::DivergingColour(2.0 * t - 1.0); },
      {{0.0, label(-1.0)},
       {0.25, label(-0.5)},
       {0.5, label(0.0)},
       {0.75, label(0.5)},
       {1.0, label(1.0)}},
      kUnit);
  int observed = 0;
  const double rms = RootMeanSquare(residual, &observed);
  const int below = area.y + area.height + 24;
  plot::DrawText(page,
                 observed > 0 ? "rms " + plot::FormatNumber(rms) + " over " +
                                    std::to_string(observed) + " pixels"
                              : "nothing observed",
                 {plot::kMargin, double(below)}, plot::kLabel, plot::Align::kLeft);
  plot::DrawSwatch(page, {area.x + area.width - 110, below}, plot::kUnobserved, "not observed");
  return page;
}

cv::Mat3b IntensityPicture(const observe::IntensityMap& map,
                           const std::vector<LightEstimate>& lights) {
  const cv::Mat1f intensity = CloseGaps(map.intensity);
  const double brightest = NearestRank<float>({intensity.begin(), intensity.end()}, 1.0);
  const double top = brightest > 0.0 ? brightest : 1.0;
  cv::Mat3b colours(intensity.size());
  for (int row = 0; row < colours.rows; ++row)
    for (int column = 0; column < colours.cols; ++column)
      colours(row, column) = plot::SequentialColour(intensity(row, column) / top);
  const cv::Size size(1080, 540);
  const bool fits = size.width % colours.cols == 0 && size.height % colours.rows == 0;
  cv::resize(colours, colours, size, 0, 0, fits ? cv::INTER_NEAREST : cv::INTER_LINEAR);

  constexpr int kLeft = 84, kBelow = 60, kBarLabels = 60, kLine = 22;
  const MapFrame frame{{{kLeft, plot::kTitleHeight}, colours.size()}};
  const cv::Rect& area = frame.area;
  const int lines = static_cast<int>(lights.size());
  cv::Mat3b page = plot::Page(kLeft + area.width + 2 * plot::kMargin + plot::kBarWidth + kBarLabels,
                              area.y + area.height + kBelow + lines * kLine + plot::kMargin);
  plot::DrawTitle(page, kLeft, "Intensity by reflected direction, and the lights found");
  plot::Place(page, colours, area.tl());
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
  plot::DrawScaleBeside(page, area, plot::SequentialColour, plot::LinearTicks(top), kUnit);
  plot::DrawSwatch(page, {area.x + area.width - 110, area.y + area.height + 44}, plot::kUnseen,
                   "not seen");
  for (int i = 0; i < lines; ++i)
    plot::DrawText(page, DescribeLight(lights[i], i + 1),
                   {kLeft, area.y + area.height + kBelow + (i + 0.5) * kLine}, plot::kLabel,
                   plot::Align::kLeft);
  return page;
}

cv::Mat3b ConvergencePicture(const std::vector<IterationRecord>& history) {
  std::vector<plot::CountedValue> values;
  for (const IterationRecord& record : history) values.push_back({record.iteration, record.rms});
  return plot::LogCurve({"Residual by iteration", "iteration", "residual rms (share of white)"},
                        values);
}

}  // namespace turnlight::estimator::pictures
