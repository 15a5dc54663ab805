#include "bench/studies/svg_chart.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/format.h"

namespace turnlight::studies {
namespace {

constexpr double kWidth = 640.0, kHeight = 400.0;
constexpr double kLeft = 70.0, kRight = 170.0, kTop = 40.0, kBottom = 55.0;
constexpr std::array kColors = {"#2b6cb0", "#c05621", "#2f855a", "#6b46c1", "#b83280", "#555555"};

double Share(const Axis& axis, double value) {
  const double share = axis.logarithmic
                           ? (std::log10(std::max(value, axis.low)) - std::log10(axis.low)) /
                                 (std::log10(axis.high) - std::log10(axis.low))
                           : (value - axis.low) / (axis.high - axis.low);
  return std::clamp(share, 0.0, 1.0);
}
double X(const Axis& axis, double value) {
  return kLeft + Share(axis, value) * (kWidth - kLeft - kRight);
}
double Y(const Axis& axis, double value) {
  return kHeight - kBottom - Share(axis, value) * (kHeight - kTop - kBottom);
}

std::vector<double> Ticks(const Axis& axis) {
  std::vector<double> ticks;
  if (axis.logarithmic) {
    for (double tick = axis.low; tick <= axis.high * 1.001; tick *= 10.0) ticks.push_back(tick);
    return ticks;
  }
  const double rough = (axis.high - axis.low) / 5.0;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = power;
  for (const double factor : {2.0, 5.0, 10.0})
    if (step < rough * 0.999) step = factor * power;
  for (double tick = std::ceil(axis.low / step) * step; tick <= axis.high * 1.0001; tick += step)
    ticks.push_back(tick);
  return ticks;
}

std::string Frame(const std::string& title, const Axis& x, const Axis& y) {
  const double bottom = kHeight - kBottom, right = kWidth - kRight;
  std::string svg = Format("<text x='%g' y='22' font-size='15'>%s</text>\n", kLeft, title.c_str());
  for (const double tick : Ticks(x)) {
    svg += Format("<path d='M%.1f %g V%g' stroke='#ddd'/>\n", X(x, tick), kTop, bottom);
    svg += Format("<text x='%.1f' y='%g' text-anchor='middle'>%g</text>\n", X(x, tick), bottom + 18,
                  tick);
  }
  for (const double tick : Ticks(y)) {
    svg += Format("<path d='M%g %.1f H%g' stroke='#ddd'/>\n", kLeft, Y(y, tick), right);
    svg += Format("<text x='%g' y='%.1f' text-anchor='end'>%g</text>\n", kLeft - 6,
                  Y(y, tick) + 4.0, tick);
  }
  svg +=
      Format("<path d='M%g %g V%g H%g' fill='none' stroke='#333'/>\n", kLeft, kTop, bottom, right);
  svg += Format("<text x='%g' y='%g' text-anchor='middle'>%s</text>\n", 0.5 * (kLeft + right),
                kHeight - 14.0, x.label.c_str());
  svg += Format("<text transform='translate(18 %g) rotate(-90)' text-anchor='middle'>%s</text>\n",
                0.5 * (kTop + bottom), y.label.c_str());
  return svg;
}

std::string Draw(const Series& series, const Axis& x, const Axis& y, const char* colour) {
  std::string svg, path;
  for (const auto& [px, py] : series.points) {
    if (series.dots)
      svg += Format("<circle cx='%.1f' cy='%.1f' r='2.2' fill='%s' fill-opacity='0.6'/>\n",
                    X(x, px), Y(y, py), colour);
    else
      path += Format("%c%.1f %.1f", path.empty() ? 'M' : 'L', X(x, px), Y(y, py));
  }
  if (!path.empty())
    svg += "<path d='" + path + "' fill='none' stroke='" + colour + "' stroke-width='1.6'" +
           (series.dashed ? " stroke-dasharray='5 4'" : "") + "/>\n";
  return svg;
}

}  // namespace

std::string SvgChart(const std::string& title, const Axis& x, const Axis& y,
                     const std::vector<Series>& series) {
  std::string svg = Format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='%g' height='%g' font-family='sans-serif' "
      "font-size='12' fill='#222'>\n<rect width='100%%' height='100%%' fill='white'/>\n",
      kWidth, kHeight);
  svg += Frame(title, x, y);
  double row = kTop + 10.0;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const char* colour = kColors[i % kColors.size()];
    svg += Draw(series[i], x, y, colour);
    if (series[i].name.empty()) continue;
    const double left = kWidth - kRight + 15.0;
    svg +=
        Format("<rect x='%g' y='%g' width='10' height='10' fill='%s'/>", left, row - 9.0, colour);
    svg += Format("<text x='%g' y='%g'>%s</text>\n", left + 16.0, row, series[i].name.c_str());
    row += 18.0;
  }
  return svg + "</svg>\n";
}

}  // namespace turnlight::studies
