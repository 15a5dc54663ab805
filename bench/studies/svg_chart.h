// Plots as SVG text: one pair of axes, lines and dots, a legend.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace turnlight::studies {

struct Axis {
  std::string label;
  double low = 0.0, high = 1.0;
  bool logarithmic = false;  // low and high are powers of ten
};

struct Series {
  std::string name;  // "": not in the legend
  std::vector<std::pair<double, double>> points;
  bool dots = false;    // else a line
  bool dashed = false;  // lines
};

// Points outside of the axes are put on their edges.
std::string SvgChart(const std::string& title, const Axis& x, const Axis& y,
                     const std::vector<Series>& series);

}  // namespace turnlight::studies
