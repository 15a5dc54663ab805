#include "calib/calibrate/placement/report.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "base/angles.h"
#include "base/format.h"
#include "base/plot/canvas.h"
#include "base/plot/chart.h"
#include "base/plot/colours.h"

namespace turnlight::calib::calibrate::placement {
namespace {

using Eigen::Vector2d;

constexpr int kTileWidth = 400, kTileHeight = 320, kAcross = 3, kMostTiles = 6;
constexpr double kRoom = 1.25;         // of a tile around the target
constexpr double kDisplayTop = 0.995;  // quantile that is white
constexpr int kBins = 90, kCellWidth = 8, kCellHeight = 22, kLabelWidth = 150;
const cv::Vec3b kOutlineColour(255, 176, 0), kLostColour(235, 45, 75);

double SigmaDeg(const Placement& placement) {
  return RadToDeg(std::sqrt(placement.covariance.topLeftCorner<3, 3>().trace()));
}

double ShiftSigma(const Matrix6& covariance) {
  return std::sqrt(covariance.bottomRightCorner<3, 3>().trace());
}

// Two views of one place of the table, the first and the last of them.
std::string ClosureText(const Placement& placement, const std::vector<View>& views,
                        const std::string& unit) {
  for (std::size_t last = views.size(); last-- > 1;) {
    if (placement.views[last].used == 0 || placement.views[0].used == 0) continue;
    if (std::abs(std::remainder(views[last].angle_deg - views[0].angle_deg, 360.0)) > 0.5) continue;
    const double apart = (placement.views[last].shift - placement.views[0].shift).norm();
    return Format("closure: the outlines at %.1f and %.1f deg are %.3f px apart, %.3g %s\n",
                  views[0].angle_deg, views[last].angle_deg, apart, apart * placement.pixel_length,
                  unit.c_str());
  }
  return "";
}

// Views to show: spread evenly over those that have a picture and an outline.
std::vector<std::size_t> ViewsToShow(const std::vector<cv::Mat>& pictures,
                                     const Placement& placement) {
  std::vector<std::size_t> seen, shown;
  for (std::size_t v = 0; v < placement.views.size(); ++v)
    if (placement.views[v].points > 0 && !pictures[v].empty()) seen.push_back(v);
  const std::size_t count = std::min<std::size_t>(seen.size(), kMostTiles);
  for (std::size_t i = 0; i < count; ++i) shown.push_back(seen[i * seen.size() / count]);
  return shown;
}

cv::Mat3b Photograph(const cv::Mat& picture) {
  cv::Mat3f colour;
  if (picture.channels() == 3)
    colour = picture;
  else
    cv::merge(std::vector<cv::Mat>{picture, picture, picture}, colour);
  std::vector<float> values(colour.ptr<float>(), colour.ptr<float>() + colour.total() * 3);
  std::nth_element(values.begin(),
                   values.begin() + static_cast<long>(kDisplayTop * double(values.size() - 1)),
                   values.end());
  const double top = values[static_cast<std::size_t>(kDisplayTop * double(values.size() - 1))];
  return plot::ToDisplay(colour, top > 0.0 ? 1.0 / top : 1.0, 1);
}

// A part of a picture, and how it got into its tile.
struct Cut {
  Vector2d middle;
  double scale = 1.0;
  cv::Point2d To(const Vector2d& pixel) const {
    return {0.5 * kTileWidth + scale * (pixel.x() - middle.x()),
            0.5 * kTileHeight + scale * (pixel.y() - middle.y())};
  }
};

Cut CutAround(const std::vector<std::vector<Vector2d>>& lines, const View& view) {
  Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  const auto add = [&](const Vector2d& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  };
  for (const auto& line : lines)
    for (const Vector2d& p : line) add(p);
  for (const OutlinePoint& p : view.outline) add(p.pixel);
  const Vector2d extent = (high - low).cwiseMax(1.0);
  return {0.5 * (low + high),
          std::min(kTileWidth / (kRoom * extent.x()), kTileHeight / (kRoom * extent.y()))};
}

cv::Mat3b Tile(const cv::Mat& picture, const std::vector<std::vector<Vector2d>>& lines,
               const View& view, std::size_t index, const Placement& placement) {
  const Cut cut = CutAround(lines, view);
  const cv::Matx23d transform(cut.scale, 0.0, 0.5 * kTileWidth - cut.scale * cut.middle.x(), 0.0,
                              cut.scale, 0.5 * kTileHeight - cut.scale * cut.middle.y());
  cv::Mat3b tile;
  cv::warpAffine(Photograph(picture), tile, transform, {kTileWidth, kTileHeight}, cv::INTER_LINEAR);
  for (const auto& line : lines) {
    std::vector<cv::Point2d> path;
    for (const Vector2d& p : line) path.push_back(cut.To(p));
    plot::DrawPath(tile, path, kOutlineColour, 1);
  }
  for (const PointFit& point : placement.points)
    if (point.view == index && !point.used)
      plot::DrawDisc(tile, cut.To(point.pixel), 1.3, kLostColour);
  const ViewFit& fit = placement.views[index];
  plot::DrawOutlinedText(tile, Format("%.1f\u00b0", view.angle_deg), {10.0, 16.0},
                         plot::Align::kLeft);
  plot::DrawOutlinedText(tile, Format("rms %.2f px", fit.rms),
                         {kTileWidth - 10.0, kTileHeight - 16.0}, plot::Align::kRight);
  return tile;
}

// The mean residual of each view in each direction from its middle; NaN where there is none.
cv::Mat1f ResidualsAround(const std::vector<View>& views, const Placement& placement) {
  const auto count = static_cast<int>(views.size());
  cv::Mat1f sum(count, kBins, 0.0f), number(count, kBins, 0.0f);
  std::vector<Vector2d> middle(views.size(), Vector2d::Zero());
  for (const PointFit& p : placement.points)
    middle[p.view] += p.pixel / static_cast<double>(placement.views[p.view].points);
  for (const PointFit& p : placement.points) {
    if (!p.used) continue;
    const Vector2d from = p.pixel - middle[p.view];
    const double turn = std::atan2(-from.y(), from.x()) / (2.0 * std::numbers::pi);
    const int bin = static_cast<int>((turn - std::floor(turn)) * kBins) % kBins;
    sum(static_cast<int>(p.view), bin) += static_cast<float>(p.residual);
    number(static_cast<int>(p.view), bin) += 1.0f;
  }
  for (int i = 0; i < static_cast<int>(sum.total()); ++i)
    sum(i) = number(i) > 0.0f ? sum(i) / number(i) : NAN;
  return sum;
}

}  // namespace

std::string Verdict(const Placement& placement, const std::vector<View>& views,
                    const std::string& unit) {
  const Eigen::Vector3d& t = placement.X_AT.translation;
  const Matrix6& sigma = placement.covariance;
  const char* u = unit.c_str();
  std::size_t used = 0, seen = 0;
  for (const ViewFit& view : placement.views) {
    used += view.used;
    seen += view.used > 0 ? 1 : 0;
  }
  std::string text = Format(
      "target at (%.3f, %.3f, %.3f) %s from the axis's origin, sigma (%.2g, %.2g, %.2g) %s\n",
      t.x(), t.y(), t.z(), u, std::sqrt(sigma(3, 3)), std::sqrt(sigma(4, 4)),
      std::sqrt(sigma(5, 5)), u);
  if (placement.rotation_matters) {
    const Eigen::AngleAxisd turn(placement.X_AT.rotation);
    text += Format("turned by %.3f deg about (%.3f, %.3f, %.3f), sigma %.2g deg\n",
                   RadToDeg(turn.angle()), turn.axis().x(), turn.axis().y(), turn.axis().z(),
                   SigmaDeg(placement));
  }
  if (placement.radius_sigma > 0.0)
    text += Format("radius %.4f %s, sigma %.2g\n", placement.radius, u, placement.radius_sigma);
  text += Format("of the place's sigma, outlines give %.2g %s and the calibration %.2g %s\n",
                 ShiftSigma(placement.from_outlines), u, ShiftSigma(placement.from_calibration), u);
  text += Format(
      "%zu points of %zu pictures, %.0f %% used: rms %.3f px (%.2g %s); edge offset %.3f px, sigma "
      "%.2g; neighbours count as one in %.1f\n",
      placement.points.size(), seen,
      100.0 * static_cast<double>(used) / std::max<double>(1.0, double(placement.points.size())),
      placement.rms, placement.rms * placement.pixel_length, u, placement.edge_offset,
      placement.edge_offset_sigma, placement.correlation);
  text += placement.wobble > 0.0
              ? Format(
                    "wobble: whole pictures are shifted by %.3f px rms (%.2g %s) against each "
                    "other, more than noise explains\n",
                    placement.wobble, placement.wobble * placement.pixel_length, u)
              : std::string("wobble: none that the noise would not explain\n");
  return text + ClosureText(placement, views, unit);
}

cv::Mat3b OverlayPage(const std::vector<cv::Mat>& pictures, const rig::RigCalibration& calibration,
                      const calib::TargetShape& shape, const std::vector<View>& views,
                      const Placement& placement) {
  using plot::kMargin;
  const std::vector<std::size_t> shown = ViewsToShow(pictures, placement);
  const int across = std::clamp(static_cast<int>(shown.size()), 1, kAcross);
  const int down = (static_cast<int>(shown.size()) + across - 1) / across;
  cv::Mat3b page = plot::Page(kMargin + across * (kTileWidth + kMargin),
                              plot::kTitleHeight + down * (kTileHeight + kMargin) + 2 * kMargin);
  plot::DrawTitle(page, kMargin, "The target where it was placed");
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const std::size_t v = shown[i];
    const auto lines = ExpectedOutline(calibration, shape, placement.X_AT, views[v].angle_deg);
    const int row = static_cast<int>(i) / across, column = static_cast<int>(i) % across;
    plot::Place(page, Tile(pictures[v], lines, views[v], v, placement),
                {kMargin + column * (kTileWidth + kMargin),
                 plot::kTitleHeight + row * (kTileHeight + kMargin)});
  }
  const int legend = page.rows - kMargin - 4;
  plot::DrawSwatch(page, {kMargin, legend}, kOutlineColour, "expected outline");
  plot::DrawSwatch(page, {kMargin + 170, legend}, kLostColour, "points left out");
  return page;
}

cv::Mat3b ResidualPage(const std::vector<View>& views, const Placement& placement) {
  using plot::kMargin;
  const cv::Mat1f residuals = ResidualsAround(views, placement);
  double top = 0.1;
  for (const float value : residuals)
    if (std::isfinite(value)) top = std::max(top, double(std::abs(value)));
  top = plot::RoundUp(top);
  const cv::Rect area(kLabelWidth, plot::kTitleHeight, kBins * kCellWidth,
                      residuals.rows * kCellHeight);
  cv::Mat3b page = plot::Page(area.x + area.width + 120, area.y + area.height + 64);
  plot::DrawTitle(page, kMargin, "How far the outlines lie outside the expected ones");
  cv::Mat3b map(area.size());
  for (int row = 0; row < residuals.rows; ++row)
    for (int bin = 0; bin < kBins; ++bin)
      map(cv::Rect(bin * kCellWidth, row * kCellHeight, kCellWidth, kCellHeight)) =
          plot::DivergingColour(residuals(row, bin) / top);
  plot::Place(page, map, area.tl());
  for (int row = 0; row < residuals.rows; ++row)
    plot::DrawText(page, Format("%.1f\u00b0", views[static_cast<std::size_t>(row)].angle_deg),
                   {area.x - 10.0, area.y + (row + 0.5) * kCellHeight}, plot::kLabel,
                   plot::Align::kRight);
  plot::DrawTicksBelow(page, area,
                       {{0.0, "right"}, {0.25, "top"}, {0.5, "left"}, {0.75, "bottom"}});
  plot::DrawText(page, "direction in the picture, from the middle of the outline",
                 {area.x + 0.5 * area.width, page.rows - 16.0}, plot::kLabel, plot::Align::kCenter);
  plot::DrawTextUpwards(page, "table's angle", {kMargin + 6.0, area.y + 0.5 * area.height},
                        plot::kLabel);
  plot::DrawScaleBeside(
      page, area, [](double t) { return plot::DivergingColour(2.0 * t - 1.0); },
      {{0.0, plot::FormatNumber(-top)}, {0.5, "0"}, {1.0, plot::FormatNumber(top)}}, "px");
  return page;
}

}  // namespace turnlight::calib::calibrate::placement
