#include "calib/calibrate/response/response_pictures.h"

#include <algorithm>
#include <cmath>

#include "base/plot/canvas.h"
#include "base/plot/chart.h"

namespace turnlight::calib::calibrate::response {
namespace {

using plot::Tick;

constexpr int kChartLeft = 100, kChartWidth = 820, kChartHeight = 520, kBelowChart = 66;
constexpr double kPointRadius = 2.6;
constexpr double kDarkest = 1e-3;  // of the brightest

const cv::Vec3b kGreyInk(70, 70, 70), kRedInk(196, 62, 52), kGreenInk(56, 140, 72),
    kBlueInk(52, 98, 190), kPaleInk(190, 190, 190);

cv::Vec3b InkOf(const std::string& plane) {
  if (plane.starts_with("red")) return kRedInk;
  if (plane.starts_with("green")) return kGreenInk;
  if (plane.starts_with("blue")) return kBlueInk;
  return kGreyInk;
}

struct Chart {
  cv::Mat3b page;
  cv::Rect area;

  explicit Chart(const std::string& title)
      : page(plot::Page(kChartWidth, kChartHeight)),
        area(kChartLeft, plot::kTitleHeight, kChartWidth - kChartLeft - plot::kMargin - 12,
             kChartHeight - plot::kTitleHeight - kBelowChart) {
    plot::DrawTitle(page, kChartLeft, title);
  }
  // Shares of the area, from its left and from its top.
  cv::Point2d At(double across, double down) const {
    return {area.x - 0.5 + across * area.width, area.y - 0.5 + down * area.height};
  }
  bool Holds(double across, double down) const {
    return across >= 0.0 && across <= 1.0 && down >= 0.0 && down <= 1.0;
  }
  void DrawAxes(const std::vector<Tick>& across, const std::vector<Tick>& down,
                const std::string& across_text, const std::string& up_text) {
    plot::DrawGrid(page, area, across, down);
    plot::Place(page, page(area).clone(), area.tl());
    plot::DrawTicksBelow(page, area, across);
    plot::DrawTicksLeft(page, area, down);
    plot::DrawText(page, across_text, {area.x + 0.5 * area.width, area.y + area.height + 46.0},
                   plot::kLabel, plot::Align::kCenter);
    plot::DrawTextUpwards(page, up_text, {22.0, area.y + 0.5 * area.height}, plot::kLabel);
  }
};

std::vector<Tick> Mirrored(std::vector<Tick> ticks) {
  for (Tick& tick : ticks) tick.at = 1.0 - tick.at;
  return ticks;
}

void DrawLegend(Chart& chart, const std::vector<std::pair<std::string, cv::Vec3b>>& entries) {
  int row = chart.area.y + 20;
  for (const auto& [text, ink] : entries) {
    plot::DrawSwatch(chart.page, {chart.area.x + 16, row}, ink, text);
    row += 20;
  }
}

// From -top to top, upwards.
std::vector<Tick> SignedTicks(double top) {
  std::vector<Tick> ticks;
  for (const Tick& tick : plot::LinearTicks(top)) {
    ticks.push_back({0.5 * (1.0 - tick.at), tick.label});
    if (tick.at > 0.0) ticks.push_back({0.5 * (1.0 + tick.at), "-" + tick.label});
  }
  return ticks;
}

// One map of a flat field, as large as the picture is wide.
cv::Mat3b DrawMap(const cv::Mat1d& values, const cv::Size& shown,
                  const std::function<cv::Vec3b(double)>& colour) {
  cv::Mat3b map(shown);
  for (int row = 0; row < shown.height; ++row)
    for (int column = 0; column < shown.width; ++column)
      map(row, column) =
          colour(values(row * values.rows / shown.height, column * values.cols / shown.width));
  return map;
}

}  // namespace

cv::Mat3b DrawPhotonTransfer(const PhotonTransfer& transfer,
                             const std::vector<std::string>& planes) {
  Chart chart("Photon transfer: the noise of one picture over the light");
  double low = HUGE_VAL, high = 0.0, least = HUGE_VAL, most = 0.0;
  for (const TransferPoint& point : transfer.points) {
    high = std::max(high, point.signal);
  }
  for (const TransferPoint& point : transfer.points) {
    // Dark frames have no place on a logarithmic axis.
    if (!(point.signal > kDarkest * high && point.variance > 0.0)) continue;
    low = std::min(low, point.signal);
    least = std::min(least, point.variance);
    most = std::max(most, point.variance);
  }
  const plot::LogAxis x = plot::LogAxisAround(low, high), y = plot::LogAxisAround(least, most);
  chart.DrawAxes(Mirrored(plot::LogTicks(x)), plot::LogTicks(y), "light, linear DN above black",
                 "variance, DN^2");
  for (const TransferPoint& point : transfer.points) {
    const double across = 1.0 - x.At(std::max(point.signal, 1e-300)),
                 down = y.At(std::max(point.variance, 1e-300));
    if (chart.Holds(across, down))
      plot::DrawDisc(chart.page, chart.At(across, down), kPointRadius, InkOf(planes[point.plane]));
  }
  std::vector<cv::Point2d> line;
  for (int i = 0; i <= 200; ++i) {
    const double signal = std::pow(10.0, x.low + (x.high - x.low) * i / 200.0);
    const double variance =
        transfer.read_noise_dn * transfer.read_noise_dn + transfer.dn_per_electron * signal;
    const double down = y.At(variance);
    if (chart.Holds(i / 200.0, down)) line.push_back(chart.At(i / 200.0, down));
  }
  plot::DrawPath(chart.page, line, plot::kInk, 1);
  std::vector<std::pair<std::string, cv::Vec3b>> entries;
  for (const std::string& plane : planes) entries.emplace_back(plane, InkOf(plane));
  entries.emplace_back("fit: " + plot::FormatNumber(transfer.dn_per_electron) +
                           " DN per electron, read noise " +
                           plot::FormatNumber(transfer.read_noise_dn) + " DN",
                       plot::kInk);
  DrawLegend(chart, entries);
  return chart.page;
}

cv::Mat3b DrawLinearity(const ResponseCurve& curve) {
  Chart chart("Linearity: a block's light over its exposure, against its mean");
  double top = 1e-5, right = 0.0;
  for (const LinearityPoint& point : curve.points) {
    top = std::max({top, 100.0 * std::abs(point.deviation),
                    std::min(100.0 * std::abs(point.linear_deviation), 100.0)});
    right = std::max(right, point.dn);
  }
  top = plot::RoundUp(top);
  right = std::max(right, curve.radiometry.white);
  chart.DrawAxes(plot::LinearTicks(right), SignedTicks(top), "DN", "deviation, % of the light");
  plot::DrawPath(chart.page, {chart.At(0.0, 0.5), chart.At(1.0, 0.5)}, plot::kInk, 1);
  const bool linear = curve.radiometry.encoding == Encoding::kLinear;
  const auto draw = [&](double dn, double deviation, const cv::Vec3b& ink) {
    const double across = dn / right, down = 0.5 * (1.0 - 100.0 * deviation / top);
    if (chart.Holds(across, down))
      plot::DrawDisc(chart.page, chart.At(across, down), kPointRadius, ink);
  };
  for (const LinearityPoint& point : curve.points)
    if (!linear) draw(point.dn, point.linear_deviation, kPaleInk);
  for (const LinearityPoint& point : curve.points) draw(point.dn, point.deviation, kBlueInk);
  std::vector<std::pair<std::string, cv::Vec3b>> entries{{"as taken", kBlueInk}};
  if (!linear) entries.emplace_back("as if it were linear", kPaleInk);
  DrawLegend(chart, entries);
  return chart.page;
}

cv::Mat3b DrawFlatField(const FlatField& flat, const cv::Size& size) {
  const int width = 400, height = std::max(1, width * size.height / size.width);
  const int gap = 100;
  cv::Mat3b page = plot::Page(2 * (plot::kMargin + width) + gap + 100,
                              plot::kTitleHeight + height + plot::kMargin + 26);
  const cv::Rect left(plot::kMargin, plot::kTitleHeight, width, height);
  const cv::Rect right(plot::kMargin + width + gap, plot::kTitleHeight, width, height);
  plot::DrawTitle(page, left.x, "Flat field: share of the centre's light");
  plot::DrawTitle(page, right.x, "What the fit leaves, %");
  double low = 1.0, worst = 0.0;
  cv::Mat1d rest(flat.measured.size());
  for (int i = 0; i < static_cast<int>(rest.total()); ++i) {
    const double measured = flat.measured(i);
    rest(i) = 100.0 * (measured / flat.fitted(i) - 1.0);
    if (!std::isfinite(measured)) continue;
    low = std::min(low, measured);
    worst = std::max(worst, std::abs(rest(i)));
  }
  low = std::floor(low * 20.0) / 20.0;
  worst = plot::RoundUp(worst);
  const auto share_colour = [&](double share) {
    return plot::SequentialColour((share - low) / (1.0 - low));
  };
  const auto rest_colour = [&](double value) { return plot::DivergingColour(value / worst); };
  plot::Place(page, DrawMap(flat.measured, {width, height}, share_colour), left.tl());
  plot::Place(page, DrawMap(rest, {width, height}, rest_colour), right.tl());
  const auto bar = [&](const cv::Rect& area, const std::function<cv::Vec3b(double)>& colour,
                       const std::vector<Tick>& ticks) {
    plot::DrawColourBar(page, {area.x + area.width + 14, area.y, plot::kBarWidth, area.height},
                        colour, ticks);
  };
  bar(left, plot::SequentialColour,
      {{1.0, plot::FormatFixed(1.0, 2)},
       {0.5, plot::FormatFixed(0.5 * (1.0 + low), 3)},
       {0.0, plot::FormatFixed(low, 2)}});
  bar(right, [](double t) { return plot::DivergingColour(2.0 * t - 1.0); },
      {{1.0, plot::FormatNumber(worst)}, {0.5, "0"}, {0.0, plot::FormatNumber(-worst)}});
  plot::DrawText(page,
                 "darkest corner " + plot::FormatFixed(flat.corner_share, 3) + ", centre at (" +
                     plot::FormatFixed(flat.vignetting.center_x, 0) + ", " +
                     plot::FormatFixed(flat.vignetting.center_y, 0) + ")",
                 {double(left.x), left.y + left.height + 22.0}, plot::kLabel, plot::Align::kLeft);
  return page;
}

}  // namespace turnlight::calib::calibrate::response
