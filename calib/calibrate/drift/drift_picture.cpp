#include <algorithm>
#include <array>
#include <cmath>

#include "base/format.h"
#include "base/plot/canvas.h"
#include "base/statistics.h"
#include "calib/calibrate/drift/drift_words.h"

namespace turnlight::calib::calibrate::drift {
namespace {

constexpr int kPanelWidth = 560;
constexpr int kHead = 56, kFoot = 64;              // above and below the panels
constexpr double kRoom = 1.2, kLeastShare = 0.05;  // around the points; of the picture
constexpr double kArrow = 36.0;                    // pixels of the page: of a long residual
constexpr double kLongQuantile = 0.95;             // which one is long
constexpr double kLeastShown = 0.2;       // pixels: a picture of noise does not look like drift
constexpr std::size_t kMostArrows = 600;  // of a panel
constexpr std::size_t kViewsInLegend = 6;
const std::array<cv::Vec3b, 6> kViewColours{cv::Vec3b(0, 90, 181),   cv::Vec3b(220, 50, 32),
                                            cv::Vec3b(0, 140, 100),  cv::Vec3b(200, 130, 0),
                                            cv::Vec3b(120, 60, 160), cv::Vec3b(90, 90, 90)};

// From picture to page.
struct Panel {
  cv::Point2d corner;
  Eigen::Vector2d low;                 // what is at the corner
  double scale = 1.0, enlarged = 1.0;  // of places, and of residuals
  cv::Point2d To(const Eigen::Vector2d& pixel) const {
    return {corner.x + scale * (pixel.x() - low.x()), corner.y + scale * (pixel.y() - low.y())};
  }
};

// What is shown of the picture: all points and some room, in the picture's shape.
struct Area {
  Eigen::Vector2d low, high;
};

Area AreaOf(const DriftReport& report, const cv::Size& picture) {
  const Eigen::Vector2d size(picture.width, picture.height);
  if (report.points.empty()) return {Eigen::Vector2d::Zero(), size};
  Eigen::Vector2d low = report.points.front().pixel, high = low;
  for (const PointDrift& point : report.points) {
    low = low.cwiseMin(point.pixel);
    high = high.cwiseMax(point.pixel);
  }
  const double share = std::min(1.0, kRoom * (high - low).cwiseQuotient(size).maxCoeff());
  const Eigen::Vector2d corner =
      (0.5 * (low + high) - 0.5 * share * size).cwiseMin((1.0 - share) * size).cwiseMax(0.0);
  return {corner, corner + std::max(share, kLeastShare) * size};
}

void DrawArrow(cv::Mat3b& page, cv::Point2d from, cv::Point2d by, const cv::Vec3b& colour) {
  const double length = std::hypot(by.x, by.y);
  plot::DrawDisc(page, from, 1.6, colour);
  if (length < 1.0) return;
  const cv::Point2d to = from + by;
  plot::DrawPath(page, {from, to}, colour, 1);
  const cv::Point2d back = by * (-std::min(5.0, 0.4 * length) / length);
  const cv::Point2d side(-back.y, back.x);
  plot::DrawPath(page, {to + back + 0.5 * side, to, to + back - 0.5 * side}, colour, 1);
}

double EnlargementOf(const DriftReport& report) {
  std::vector<double> lengths;
  for (const PointDrift& point : report.points) lengths.push_back(point.stored.norm());
  const double length = std::max(kLeastShown, LowerQuantile(lengths, kLongQuantile));
  return plot::RoundDown(kArrow / length);
}

double RmsOf(const std::vector<PointDrift>& points, const Eigen::Vector2d PointDrift::*residual) {
  double sum = 0.0;
  for (const PointDrift& point : points) sum += (point.*residual).squaredNorm();
  return std::sqrt(sum / std::max<double>(1.0, static_cast<double>(points.size())));
}

void DrawPanel(cv::Mat3b& page, const Panel& panel, const Area& area, const DriftReport& report,
               const Eigen::Vector2d PointDrift::*residual, const std::string& title) {
  const cv::Point2d end = panel.corner + panel.scale * cv::Point2d(area.high.x() - area.low.x(),
                                                                   area.high.y() - area.low.y());
  plot::DrawPath(page, {panel.corner, {end.x, panel.corner.y}, end, {panel.corner.x, end.y}},
                 plot::kFaint, 1, true);
  plot::DrawText(page, title + Format(": %.3f px rms of a point", RmsOf(report.points, residual)),
                 {panel.corner.x, panel.corner.y - 14.0}, plot::kLabel, plot::Align::kLeft);
  const std::size_t every = std::max<std::size_t>(1, report.points.size() / kMostArrows);
  for (std::size_t i = 0; i < report.points.size(); i += every) {
    const PointDrift& point = report.points[i];
    const Eigen::Vector2d by = panel.enlarged * (point.*residual);
    DrawArrow(page, panel.To(point.pixel), {by.x(), by.y()},
              kViewColours[point.view % kViewColours.size()]);
  }
}

void DrawLegend(cv::Mat3b& page, const DriftReport& report, double enlarged, int y) {
  const double one = plot::RoundDown(2.0 * kArrow / enlarged);
  double x = plot::kMargin;
  DrawArrow(page, {x, static_cast<double>(y)}, {one * enlarged, 0.0}, plot::kInk);
  const std::string text = plot::FormatNumber(one) + " px";
  x += one * enlarged + 10.0;
  plot::DrawText(page, text, {x, static_cast<double>(y)}, plot::kLabel, plot::Align::kLeft);
  x += plot::TextWidth(text, plot::kLabel) + 36.0;
  for (std::size_t v = 0; v < std::min(report.views.size(), kViewsInLegend); ++v) {
    plot::DrawDisc(page, {x, static_cast<double>(y)}, 4.0, kViewColours[v]);
    plot::DrawText(page, report.views[v], {x + 10.0, static_cast<double>(y)}, plot::kLabel,
                   plot::Align::kLeft);
    x += plot::TextWidth(report.views[v], plot::kLabel) + 34.0;
  }
}

}  // namespace

cv::Mat3b DrawDrift(const DriftReport& report, const cv::Size& picture) {
  const Area area = AreaOf(report, picture);
  const double scale = kPanelWidth / (area.high.x() - area.low.x());
  const int height = static_cast<int>(std::ceil(scale * (area.high.y() - area.low.y())));
  cv::Mat3b page =
      plot::Page(2 * kPanelWidth + 3 * plot::kMargin, plot::kMargin + kHead + height + kFoot);
  const double top = plot::kMargin + kHead;
  plot::DrawText(page, "Points against the calibration: " + VerdictWord(report.verdict),
                 {static_cast<double>(plot::kMargin), plot::kMargin + 8.0}, plot::kCaption,
                 plot::Align::kLeft);
  const double enlarged = EnlargementOf(report);
  DrawPanel(page, {{static_cast<double>(plot::kMargin), top}, area.low, scale, enlarged}, area,
            report, &PointDrift::stored, "as it is stored");
  std::string after = "with what it may have wrong";
  if (report.verdict == Verdict::kDrifted) {
    after = "after a change of ";
    for (std::size_t i = 0; i < report.found.causes.size(); ++i)
      after += (i > 0 ? ", " : "") + CauseName(report.found.causes[i]);
  }
  DrawPanel(page, {{kPanelWidth + 2.0 * plot::kMargin, top}, area.low, scale, enlarged}, area,
            report, &PointDrift::found, after);
  DrawLegend(page, report, enlarged, static_cast<int>(top) + height + kFoot / 2);
  return page;
}

}  // namespace turnlight::calib::calibrate::drift
