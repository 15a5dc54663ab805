#include <algorithm>
#include <array>
#include <cmath>

#include "base/angles.h"
#include "base/format.h"
#include "base/plot/chart.h"
#include "calib/calibrate/axis/axis_report.h"
#include "calib/rig_geometry.h"

namespace turnlight::calib::calibrate::axis {
namespace {

using plot::Align;
using plot::Tick;

const cv::Vec3b kBlue = plot::DivergingColour(-0.9);
const cv::Vec3b kRed = plot::DivergingColour(0.9);
const cv::Vec3b kPaleBlue = plot::DivergingColour(-0.15);
constexpr int kLeftOf = 100;  // charts begin here

struct Chart {
  cv::Rect area;
  double left = 0.0, right = 1.0, bottom = 0.0, top = 1.0;

  cv::Point2d At(double x, double y) const {
    return {area.x - 0.5 + area.width * (x - left) / (right - left),
            area.y - 0.5 + area.height * (top - y) / (top - bottom)};
  }
};

std::vector<Tick> AngleTicks(const Chart& chart) {
  const double span = chart.right - chart.left;
  const double step = span > 180.0 ? 45.0 * std::ceil(span / 400.0) : plot::RoundUp(span / 8.0);
  std::vector<Tick> ticks;
  for (double at = std::ceil(chart.left / step) * step; at <= chart.right + 1e-9; at += step)
    ticks.push_back({(at - chart.left) / span, plot::FormatNumber(at) + "\u00b0"});
  return ticks;
}

std::vector<Tick> LeftTicks(const Chart& chart) {
  std::vector<Tick> ticks;
  for (const Tick& tick : plot::LinearTicks(chart.top)) {
    const double value = tick.at * chart.top;
    for (const double signed_value : {value, -value})
      if (signed_value >= chart.bottom - 1e-9 * chart.top && (value > 0.0 || signed_value == value))
        ticks.push_back({(chart.top - signed_value) / (chart.top - chart.bottom),
                         plot::FormatNumber(signed_value)});
    if (value == 0.0) ticks.resize(1);
  }
  return ticks;
}

void DrawFrame(cv::Mat3b& page, const Chart& chart, const std::string& up) {
  const auto across = AngleTicks(chart), down = LeftTicks(chart);
  plot::DrawGrid(page, chart.area, across, down);
  plot::Place(page, page(chart.area).clone(), chart.area.tl());
  plot::DrawTicksBelow(page, chart.area, across);
  plot::DrawTicksLeft(page, chart.area, down);
  plot::DrawTextUpwards(page, up, {22.0, chart.area.y + 0.5 * chart.area.height}, plot::kLabel);
}

void DrawBand(cv::Mat3b& page, const Chart& chart, double half_height) {
  const cv::Point2d a = chart.At(chart.left, half_height), b = chart.At(chart.right, -half_height);
  cv::Rect band(cv::Point(cvRound(a.x), cvRound(a.y)), cv::Point(cvRound(b.x), cvRound(b.y) + 1));
  band &= chart.area;
  if (!band.empty()) page(band).setTo(kPaleBlue);
}

// A cross on the lower edge: a view that was left out.
void DrawCross(cv::Mat3b& page, const cv::Point2d& at) {
  plot::DrawPath(page, {at + cv::Point2d(-4, -4), at + cv::Point2d(4, 4)}, kRed, 2);
  plot::DrawPath(page, {at + cv::Point2d(-4, 4), at + cv::Point2d(4, -4)}, kRed, 2);
}

void DrawDeviations(cv::Mat3b& page, Chart chart, const AxisCalibration& axis,
                    const std::vector<AxisView>& views) {
  double most = std::max(1.5 * axis.angle_sigma_deg, 1e-4);
  for (const FittedView& view : axis.views)
    if (view.used) most = std::max(most, std::abs(view.deviation_deg) + view.deviation_sigma_deg);
  chart.top = plot::RoundUp(1e3 * most);
  chart.bottom = -chart.top;
  DrawBand(page, chart, 1e3 * axis.angle_sigma_deg);
  DrawFrame(page, chart, "turned less reported, 0.001\u00b0");
  plot::DrawPath(page, {chart.At(chart.left, 0.0), chart.At(chart.right, 0.0)}, plot::kInk, 1);
  for (const FittedView& view : axis.views) {
    const double x = views[view.view].angle_deg;
    if (!view.used) {
      DrawCross(page, chart.At(x, chart.bottom) - cv::Point2d(0, 8));
      continue;
    }
    const double y = 1e3 * view.deviation_deg, sigma = 1e3 * view.deviation_sigma_deg;
    plot::DrawPath(page, {chart.At(x, y - sigma), chart.At(x, y + sigma)}, kBlue, 1);
    plot::DrawDisc(page, chart.At(x, y), 3.5, kBlue);
  }
}

void DrawRms(cv::Mat3b& page, Chart chart, const AxisCalibration& axis,
             const std::vector<AxisView>& views) {
  double most = std::max(axis.corner_sigma_px, 1e-3);
  for (const FittedView& view : axis.views) most = std::max(most, view.rms_px);
  chart.top = plot::RoundUp(1.05 * most);
  DrawFrame(page, chart, "corners' rms, px");
  plot::DrawPath(
      page,
      {chart.At(chart.left, axis.corner_sigma_px), chart.At(chart.right, axis.corner_sigma_px)},
      kPaleBlue, 3);
  for (const FittedView& view : axis.views) {
    const double x = views[view.view].angle_deg;
    if (view.used)
      plot::DrawDisc(page, chart.At(x, view.rms_px), 3.5, view.outliers > 0 ? kRed : kBlue);
    else
      DrawCross(page, chart.At(x, 0.0) - cv::Point2d(0, 8));
  }
}

// From above (x right, y up) or from the side (x right, z up), to scale.
struct Drawing {
  cv::Rect area;
  double scale = 1.0;  // pixels by length units
  cv::Point2d origin;  // of W, on the page
  bool from_above = true;

  cv::Point2d At(const Eigen::Vector3d& p_W) const {
    return origin + scale * cv::Point2d(p_W.x(), -(from_above ? p_W.y() : p_W.z()));
  }
};

std::array<Eigen::Vector3d, 4> CornersOf(const board::Board& board) {
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : BoardPoints(board)) last = last.cwiseMax(p);
  return {Eigen::Vector3d::Zero(), {last.x(), 0, 0}, {last.x(), last.y(), 0}, {0, last.y(), 0}};
}

void DrawCamera(cv::Mat3b& page, const Drawing& drawing, const Pose& X_WC, double size) {
  // A pyramid whose tip is the centre of projection.
  const std::array<Eigen::Vector3d, 4> base{
      {{-0.6, -0.4, 1}, {0.6, -0.4, 1}, {0.6, 0.4, 1}, {-0.6, 0.4, 1}}};
  std::vector<cv::Point2d> outline;
  const cv::Point2d tip = drawing.At(X_WC.translation);
  for (const Eigen::Vector3d& corner : base) outline.push_back(drawing.At(X_WC * (size * corner)));
  plot::DrawPath(page, outline, plot::kInk, 2, true);
  for (const cv::Point2d& corner : outline) plot::DrawPath(page, {tip, corner}, plot::kInk, 1);
  plot::DrawDisc(page, tip, 3.0, plot::kInk);
  plot::DrawText(page, "camera", tip + cv::Point2d(0, -30), plot::kLabel, Align::kCenter);
}

void DrawBoards(cv::Mat3b& page, const Drawing& drawing, const AxisCalibration& axis,
                const board::Board& board) {
  const auto corners = CornersOf(board);
  const auto draw = [&](const Pose& X_WB, const cv::Vec3b& colour, int thickness) {
    std::vector<cv::Point2d> outline;
    for (const Eigen::Vector3d& corner : corners) outline.push_back(drawing.At(X_WB * corner));
    plot::DrawPath(page, outline, colour, thickness, true);
  };
  for (const FittedView& view : axis.views)
    if (view.used) draw(axis.X_WC * view.X_CB, plot::kFaint, 1);
  draw(axis.X_WB, kBlue, 2);
}

// The way the board's middle goes as the reported angle grows, from 0 on.
void DrawPathOfBoard(cv::Mat3b& page, const Drawing& drawing, const AxisCalibration& axis,
                     const board::Board& board) {
  const auto corners = CornersOf(board);
  const Eigen::Vector3d middle = axis.X_WB * (0.5 * corners[2]);
  std::vector<cv::Point2d> path;
  for (int i = 0; i <= 60; ++i)
    path.push_back(
        drawing.At(Turn(Eigen::Vector3d::UnitZ(), DegToRad(axis.angle_scale * i)) * middle));
  if (cv::norm(path.back() - path.front()) < 4.0) return;
  plot::DrawPath(page, path, kRed, 2);
  const cv::Point2d along = (path[60] - path[57]) / cv::norm(path[60] - path[57]);
  const cv::Point2d across(-along.y, along.x);
  for (const double side : {-1.0, 1.0})
    plot::DrawPath(page, {path[60], path[60] - 9.0 * along + side * 5.0 * across}, kRed, 2);
}

void DrawPart(cv::Mat3b& page, const Drawing& drawing, const AxisCalibration& axis,
              const board::Board& board) {
  plot::Place(page, page(drawing.area).clone(), drawing.area.tl());
  cv::Mat3b part = page;
  DrawBoards(part, drawing, axis, board);
  if (drawing.from_above) {
    DrawPathOfBoard(part, drawing, axis, board);
    plot::DrawDisc(part, drawing.origin, 4.0, kRed);
  } else {
    plot::DrawPath(part,
                   {{drawing.origin.x, drawing.area.y + 28.0},
                    {drawing.origin.x, drawing.area.y + drawing.area.height - 8.0}},
                   kRed, 1);
    plot::DrawDisc(part, drawing.origin, 4.0, kRed);
  }
  plot::DrawText(part,
                 drawing.from_above ? "from above: x right, y up" : "from the side: x right, z up",
                 {drawing.area.x + 10.0, drawing.area.y + 14.0}, plot::kLabel, Align::kLeft);
  DrawCamera(part, drawing, axis.X_WC, 30.0 / drawing.scale);
}

}  // namespace

cv::Mat3b DrawAxisViews(const AxisCalibration& axis, const std::vector<AxisView>& views) {
  cv::Mat3b page = plot::Page(860, 620);
  plot::DrawTitle(page, kLeftOf, "Where the board stands, view by view");
  Chart chart;
  chart.left = chart.right = views.front().angle_deg;
  for (const AxisView& view : views) {
    chart.left = std::min(chart.left, view.angle_deg);
    chart.right = std::max(chart.right, view.angle_deg);
  }
  const double margin = std::max(0.02 * (chart.right - chart.left), 0.1);
  chart.left -= margin;
  chart.right += margin;
  const int width = page.cols - kLeftOf - plot::kMargin - 12;
  chart.area = {kLeftOf, plot::kTitleHeight, width, 300};
  DrawDeviations(page, chart, axis, views);
  chart.area = {kLeftOf, plot::kTitleHeight + 346, width, 140};
  DrawRms(page, chart, axis, views);
  plot::DrawText(page, "angle that the table reports",
                 {kLeftOf + 0.5 * width, chart.area.y + 140 + 42.0}, plot::kLabel, Align::kCenter);
  const double y = page.rows - 20.0;
  plot::DrawSwatch(
      page, {kLeftOf, int(y)}, kPaleBlue,
      Format("sigma: %.4f\u00b0, %.3f px", axis.angle_sigma_deg, axis.corner_sigma_px));
  DrawCross(page, {kLeftOf + 330.0, y});
  plot::DrawText(page, "left out", {kLeftOf + 344.0, y}, plot::kLabel, Align::kLeft);
  plot::DrawDisc(page, {kLeftOf + 450.0, y}, 3.5, kRed);
  plot::DrawText(page, "points left out", {kLeftOf + 464.0, y}, plot::kLabel, Align::kLeft);
  return page;
}

cv::Mat3b DrawAxisPlan(const AxisCalibration& axis, const board::Board& board,
                       const std::string& length_unit) {
  double left = 0.0, right = 0.0, y = 0.0, low = 0.0, high = 0.0;
  const auto include = [&](const Eigen::Vector3d& p) {
    left = std::min(left, p.x());
    right = std::max(right, p.x());
    y = std::max(y, std::abs(p.y()));
    low = std::min(low, p.z());
    high = std::max(high, p.z());
  };
  include(axis.X_WC.translation);
  for (const FittedView& view : axis.views)
    for (const Eigen::Vector3d& corner : CornersOf(board))
      if (view.used) include(axis.X_WC * (view.X_CB * corner));
  constexpr double kWide = 640.0, kRoom = 50.0;
  const double scale =
      std::min({kWide / std::max(right - left, 1e-9), 420.0 / std::max(2.0 * y, 1e-9),
                420.0 / std::max(high - low, 1e-9)});
  const int width = cvRound(scale * (right - left) + 2 * kRoom + 40);
  const int above = cvRound(scale * 2 * y + 2 * kRoom);
  const int beside = cvRound(scale * (high - low) + 2 * kRoom);
  const int frame = std::max(width, 420);
  cv::Mat3b page = plot::Page(frame + 2 * plot::kMargin,
                              plot::kTitleHeight + above + beside + 2 * plot::kMargin + 24);
  plot::DrawTitle(page, plot::kMargin, "Camera, axis and board");
  const double x0 = plot::kMargin + kRoom - scale * left;
  const int second = plot::kTitleHeight + above + plot::kMargin;
  DrawPart(page,
           {{plot::kMargin, plot::kTitleHeight, frame, above},
            scale,
            {x0, plot::kTitleHeight + 0.5 * above},
            true},
           axis, board);
  DrawPart(
      page,
      {{plot::kMargin, second, frame, beside}, scale, {x0, second + kRoom + scale * high}, false},
      axis, board);
  const double bar = plot::RoundDown(0.3 * frame / scale), at = page.rows - 22.0;
  plot::DrawPath(page, {{plot::kMargin, at}, {plot::kMargin + scale * bar, at}}, plot::kInk, 3);
  plot::DrawText(page, plot::FormatNumber(bar) + " " + length_unit,
                 {plot::kMargin + scale * bar + 10.0, at}, plot::kLabel, Align::kLeft);
  plot::DrawText(page,
                 "blue: the board at 0\u00b0; red: the axis, and the board's way as angles grow",
                 {frame + double(plot::kMargin), at}, plot::kLabel, Align::kRight);
  return page;
}

}  // namespace turnlight::calib::calibrate::axis
