#include "calib/calibrate/lens/pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/format.h"
#include "calib/calibrate/lens/sensor_page.h"

namespace turnlight::calib::calibrate::lens {
namespace {

using plot::Align;

constexpr std::size_t kMostArrows = 4000;
constexpr std::size_t kMostBars = 50;
constexpr double kArrow = 14.0;  // page pixels of a residual of the rms
const cv::Vec3b kPlain = plot::DivergingColour(-0.9);
const cv::Vec3b kMarked = plot::DivergingColour(0.9);

void DrawArrow(SensorPage& sensor, const Eigen::Vector2d& pixel, const Eigen::Vector2d& by,
               double scale, const cv::Vec3b& colour) {
  const cv::Point2d from = sensor.ToPage(pixel);
  plot::DrawPath(sensor.page, {from, from + scale * cv::Point2d(by.x(), by.y())}, colour, 1);
  plot::DrawDisc(sensor.page, from, 1.5, colour);
}

ReportPicture Residuals(const LensCalibration& calibration) {
  const double scale = plot::RoundDown(kArrow / std::max(calibration.rms_px, 1e-9));
  SensorPage sensor =
      MakeSensorPage(calibration.camera().width(), calibration.camera().height(),
                     "residuals: observed less projected",
                     Format("an arrow of %s is 1 px; red: outliers",
                            (plot::FormatNumber(scale) + " pixels of this page").c_str()),
                     false);
  const std::size_t step = calibration.points.size() / kMostArrows + 1;
  for (const bool outliers : {false, true})
    for (std::size_t i = 0; i < calibration.points.size(); i += outliers ? 1 : step) {
      const FittedPoint& point = calibration.points[i];
      // Far outliers would cover the others.
      const double length = std::max(1.0, scale * point.residual.norm() / (6.0 * kArrow));
      if (point.outlier == outliers)
        DrawArrow(sensor, point.pixel, point.residual, scale / length, outliers ? kMarked : kPlain);
    }
  return {"residuals.png", sensor.page};
}

ReportPicture Views(const std::vector<PictureViews>& pictures, const LensCalibration& calibration,
                    const LensAssessment& assessment) {
  std::vector<std::size_t> order(calibration.views.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return calibration.views[a].rms_px > calibration.views[b].rms_px;
  });
  order.resize(std::min(order.size(), kMostBars));
  const auto name = [&](std::size_t view) {
    const FittedView& fitted = calibration.views[view];
    std::string text = pictures[fitted.picture].picture;
    if (text.size() > 28) text = "..." + text.substr(text.size() - 25);
    if (pictures[fitted.picture].boards.size() > 1) text += Format(", board %zu", fitted.board + 1);
    return text;
  };
  int names = 0;
  for (const std::size_t view : order) names = std::max(names, plot::TextWidth(name(view), 8.0));
  constexpr int kBar = 16;
  const int left = plot::kMargin + names + 10;
  const cv::Rect area(left, plot::kTitleHeight, 520, kBar * static_cast<int>(order.size()) + 8);
  cv::Mat3b page = plot::Page(left + area.width + 2 * plot::kMargin, area.y + area.height + 66);
  plot::DrawTitle(page, left, "rms of each view, the worst first");
  const double top = plot::RoundUp(std::max(1e-6, 1.05 * calibration.views[order[0]].rms_px));
  const auto ticks = plot::LinearTicks(top);
  plot::DrawGrid(page, area, ticks, {});
  for (std::size_t i = 0; i < order.size(); ++i) {
    const FittedView& view = calibration.views[order[i]];
    const bool doubtful = std::find(assessment.doubtful.begin(), assessment.doubtful.end(),
                                    order[i]) != assessment.doubtful.end();
    const int y = area.y + 4 + kBar * static_cast<int>(i);
    const int length = std::max(1, static_cast<int>(area.width * view.rms_px / top));
    cv::Mat(page, cv::Rect(area.x, y + 3, length, kBar - 6)) = doubtful ? kMarked : kPlain;
    plot::DrawText(page, name(order[i]), {left - 8.0, y + 0.5 * kBar}, 8.0, Align::kRight);
  }
  const double at = area.x + area.width * calibration.rms_px / top;
  plot::DrawPath(page, {{at, double(area.y)}, {at, double(area.y + area.height)}}, plot::kInk, 1);
  plot::DrawTicksBelow(page, area, ticks);
  plot::DrawText(page, "pixels per axis; the line is the rms of all; red: look at it",
                 {area.x + 0.5 * area.width, area.y + area.height + 46.0}, plot::kLabel,
                 Align::kCenter);
  return {"views.png", page};
}

ReportPicture Histogram(const LensCalibration& calibration) {
  constexpr int kBins = 48;
  constexpr double kEnd = 4.8;  // sigmas
  std::array<double, kBins> counts{};
  double total = 0.0;
  for (const FittedPoint& point : calibration.points) {
    if (point.outlier) continue;
    for (int k = 0; k < 2; ++k) {
      const double t = point.weight * point.residual[k] / std::max(calibration.noise_px, 1e-12);
      const int bin = static_cast<int>(std::floor((t + kEnd) / (2.0 * kEnd) * kBins));
      total += 1.0;
      if (bin >= 0 && bin < kBins) counts[static_cast<std::size_t>(bin)] += 1.0;
    }
  }
  const double bin_width = 2.0 * kEnd / kBins;
  const double peak = 1.0 / std::sqrt(2.0 * std::numbers::pi);
  double highest = peak;
  for (double& count : counts)
    highest = std::max(highest, count /= std::max(1.0, total) * bin_width);
  cv::Mat3b page = plot::Page(760, 480);
  const cv::Rect area(60, plot::kTitleHeight, 676, 360);
  plot::DrawTitle(page, area.x, "residuals per axis, and the normal distribution");
  std::vector<plot::Tick> ticks;
  for (int sigma = -4; sigma <= 4; ++sigma)
    ticks.push_back({(sigma + kEnd) / (2.0 * kEnd), std::to_string(sigma)});
  plot::DrawGrid(page, area, ticks, {});
  const auto height = [&](double density) { return 0.95 * area.height * density / highest; };
  for (int bin = 0; bin < kBins; ++bin) {
    const int x0 = area.x + area.width * bin / kBins, x1 = area.x + area.width * (bin + 1) / kBins;
    const int h = static_cast<int>(height(counts[static_cast<std::size_t>(bin)]));
    if (h > 0)
      cv::Mat(page, cv::Rect(x0 + 1, area.y + area.height - h, x1 - x0 - 1, h)) =
          plot::DivergingColour(-0.6);
  }
  std::vector<cv::Point2d> curve;
  for (int x = 0; x <= area.width; x += 2) {
    const double t = (static_cast<double>(x) / area.width * 2.0 - 1.0) * kEnd;
    curve.emplace_back(area.x + x, area.y + area.height - height(peak * std::exp(-0.5 * t * t)));
  }
  plot::DrawPath(page, curve, plot::kInk, 2);
  plot::DrawTicksBelow(page, area, ticks);
  plot::DrawText(page,
                 Format("in standard deviations (%.3g px); %zu outliers are left out",
                        calibration.noise_px, calibration.outliers),
                 {area.x + 0.5 * area.width, area.y + area.height + 46.0}, plot::kLabel,
                 Align::kCenter);
  return {"histogram.png", page};
}

ReportPicture CoverageMap(const LensCalibration& calibration, const LensAssessment& assessment) {
  const Coverage& coverage = assessment.coverage;
  SensorPage sensor = MakeSensorPage(
      calibration.camera().width(), calibration.camera().height(),
      "points seen in each cell of the sensor",
      Format("the boards' outlines cover %.0f %% of the picture", 100.0 * assessment.covered_share),
      false);
  const double most = static_cast<double>(
      std::max<std::size_t>(1, *std::max_element(coverage.points.begin(), coverage.points.end())));
  for (int row = 0; row < coverage.rows; ++row)
    for (int column = 0; column < coverage.columns; ++column) {
      const std::size_t count =
          coverage.points[static_cast<std::size_t>(row * coverage.columns + column)];
      const auto edge = [](int i, int count_of, int size) { return size * i / count_of; };
      const cv::Rect& area = sensor.area;
      const int x0 = area.x + edge(column, coverage.columns, area.width);
      const int x1 = area.x + edge(column + 1, coverage.columns, area.width);
      const int y0 = area.y + edge(row, coverage.rows, area.height);
      const int y1 = area.y + edge(row + 1, coverage.rows, area.height);
      const double share = std::sqrt(static_cast<double>(count) / most);
      const cv::Vec3b colour =
          count == 0 ? plot::kUnobserved : plot::DivergingColour(-0.15 - 0.75 * share);
      cv::Mat(sensor.page, cv::Rect(x0 + 1, y0 + 1, x1 - x0 - 2, y1 - y0 - 2)) = colour;
      plot::DrawText(sensor.page, std::to_string(count), {0.5 * (x0 + x1), 0.5 * (y0 + y1)}, 9.0,
                     Align::kCenter, share > 0.5 ? plot::kPaper : plot::kInk);
    }
  return {"coverage.png", sensor.page};
}

// The value in words at the middle of each ninth of the picture.
void LabelNinths(SensorPage& sensor, const ImageGrid& grid, const std::vector<double>& values) {
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 3; ++x) {
      const int column = grid.columns * (2 * x + 1) / 6, row = grid.rows * (2 * y + 1) / 6;
      const auto i = static_cast<std::size_t>(row * grid.columns + column);
      if (std::isfinite(values[i]))
        plot::DrawOutlinedText(sensor.page, Format("%.2g", values[i]),
                               sensor.ToPage(grid.pixels[i]), Align::kCenter);
    }
}

ReportPicture UncertaintyMap(const LensCalibration& calibration, const LensAssessment& assessment,
                             const std::vector<double>& sigmas, const std::string& where,
                             const std::string& name) {
  SensorPage sensor =
      MakeSensorPage(calibration.camera().width(), calibration.camera().height(),
                     "uncertainty of a projection " + where,
                     "1 sigma in the worst direction; dots: no board was seen there", true);
  DrawLogMap(sensor, assessment.grid, sigmas, "pixels");
  for (std::size_t i = 0; i < assessment.covered.size(); ++i)
    if (!assessment.covered[i] && i % 2 == 0)
      plot::DrawDisc(sensor.page, sensor.ToPage(assessment.grid.pixels[i]), 1.5, plot::kPaper);
  LabelNinths(sensor, assessment.grid, sigmas);
  return {name, sensor.page};
}

ReportPicture HalvesMap(const LensCalibration& calibration, const LensAssessment& assessment) {
  const CrossValidation& halves = *assessment.halves;
  std::vector<double> lengths;
  for (std::size_t i = 0; i < halves.difference.size(); ++i)
    lengths.push_back(halves.compared[i] ? halves.difference[i].norm()
                                         : std::numeric_limits<double>::quiet_NaN());
  SensorPage sensor = MakeSensorPage(
      calibration.camera().width(), calibration.camera().height(),
      "two halves of the pictures: difference of their projections",
      Format(
          "where both cover, after the rotation between them; %.2g px rms, noise explains %.2g px",
          halves.rms_px, halves.expected_px),
      true);
  DrawLogMap(sensor, assessment.grid, lengths, "pixels");
  LabelNinths(sensor, assessment.grid, lengths);
  return {"halves.png", sensor.page};
}

}  // namespace

std::vector<ReportPicture> ReportPictures(const std::vector<PictureViews>& pictures,
                                          const LensCalibration& calibration,
                                          const LensAssessment& assessment,
                                          const std::string& length_unit) {
  std::vector<ReportPicture> report{Residuals(calibration),
                                    Views(pictures, calibration, assessment),
                                    Histogram(calibration), CoverageMap(calibration, assessment),
                                    UncertaintyMap(calibration, assessment, assessment.sigma_px,
                                                   "at infinity", "uncertainty.png")};
  if (assessment.distance)
    report.push_back(UncertaintyMap(calibration, assessment, assessment.sigma_at_distance_px,
                                    Format("at %g %s", *assessment.distance, length_unit.c_str()),
                                    "uncertainty_at_distance.png"));
  if (assessment.halves) report.push_back(HalvesMap(calibration, assessment));
  return report;
}

}  // namespace turnlight::calib::calibrate::lens
