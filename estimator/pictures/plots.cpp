#include "estimator/pictures/plots.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "base/angles.h"
#include "base/plot/chart.h"
#include "base/plot/sky_map.h"
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

std::string DescribeLight(const LightEstimate& light, int number) {
  std::string text = std::to_string(number) + ":  " + plot::SkyAngles(light.direction_at_reference);
  if (std::isfinite(light.direction_sigma))
    text += ",  3 sigma " + plot::FormatNumber(RadToDeg(3.0 * light.direction_sigma)) + kDegree;
  return text + ",  intensity " + plot::FormatNumber(light.light.intensity);
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
  std::vector<plot::SkyMark> marks;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const int number = static_cast<int>(i) + 1;
    marks.push_back({lights[i].direction_at_reference, 3.0 * lights[i].direction_sigma,
                     std::to_string(number), DescribeLight(lights[i], number)});
  }
  return plot::SkyMap(map.intensity,
                      {"Intensity by reflected direction, and the lights found", kUnit}, marks);
}

cv::Mat3b ConvergencePicture(const std::vector<IterationRecord>& history) {
  std::vector<plot::CountedValue> values;
  for (const IterationRecord& record : history) values.push_back({record.iteration, record.rms});
  return plot::LogCurve({"Residual by iteration", "iteration", "residual rms (share of white)"},
                        values);
}

}  // namespace turnlight::estimator::pictures
