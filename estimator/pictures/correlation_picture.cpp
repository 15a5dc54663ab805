#include "estimator/pictures/correlation_picture.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/plot/chart.h"

namespace turnlight::estimator::pictures {
namespace {

constexpr int kPlaces = 920;                        // about the matrix's size on the page
constexpr int kLeastSquare = 15, kMostSquare = 46;  // pixels from one row to the next
constexpr int kSquareOfNumbers = 46;                // squares as large have their number in them
constexpr double kNumberHeight = 7.5;               // of its capitals
constexpr int kGroupGap = 5;                        // after the rows of a light
constexpr int kLabelGap = 8;                        // between a name and the matrix
constexpr int kBarLabels = 50;                      // room for the numbers of the colour bar
constexpr const char* kTitle = "Correlation of the errors";

// Where rows (and columns) begin, and how large all is.
struct Layout {
  int square = 0;            // from one row to the next, a line included
  std::vector<int> begin;    // of each row, from the matrix's top
  int size = 0;              // of the matrix
  double text_height = 0.0;  // of names
  std::vector<std::string> names;
  int longest = 0;  // of the names, pixels
};

Layout LayoutOf(const uncertainty::Correlation& correlation) {
  Layout out;
  const auto& quantities = correlation.quantities;
  const int count = static_cast<int>(quantities.size());
  out.square = std::clamp(kPlaces / count, kLeastSquare, kMostSquare);
  out.text_height = std::min(plot::kLabel, 0.56 * out.square);
  for (std::size_t i = 0; i < quantities.size(); ++i) {
    if (i > 0 && quantities[i].light != quantities[i - 1].light) out.size += kGroupGap;
    out.begin.push_back(out.size);
    out.size += out.square;
    out.names.push_back(quantities[i].name());
    out.longest = std::max(out.longest, plot::TextWidth(out.names.back(), out.text_height));
  }
  --out.size;  // no line after the last
  return out;
}

void DrawNames(cv::Mat3b& page, const Layout& layout, cv::Point corner) {
  const double middle = 0.5 * (layout.square - 2);
  const double bottom = corner.y + layout.size + kLabelGap;
  for (std::size_t i = 0; i < layout.names.size(); ++i) {
    const std::string& name = layout.names[i];
    plot::DrawText(page, name, {double(corner.x - kLabelGap), corner.y + layout.begin[i] + middle},
                   layout.text_height, plot::Align::kRight);
    plot::DrawTextUpwards(page, name,
                          {corner.x + layout.begin[i] + middle,
                           bottom + 0.5 * plot::TextWidth(name, layout.text_height)},
                          layout.text_height);
  }
}

void DrawSquares(cv::Mat3b& page, const Layout& layout, const Eigen::MatrixXd& matrix,
                 cv::Point corner) {
  const int size = layout.square - 1;
  for (std::size_t i = 0; i < layout.begin.size(); ++i)
    for (std::size_t j = 0; j < layout.begin.size(); ++j) {
      const double r = matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      const cv::Point at = corner + cv::Point(layout.begin[j], layout.begin[i]);
      const cv::Vec3b colour = plot::DivergingColour(r);
      plot::Place(page, cv::Mat3b(size, size, colour), at);  // neighbours share a line
      if (layout.square < kSquareOfNumbers) continue;
      const bool dark = 0.3 * colour[0] + 0.6 * colour[1] + 0.1 * colour[2] < 140.0;
      plot::DrawText(page, plot::FormatFixed(r, 2),
                     {at.x + 0.5 * (size - 1), at.y + 0.5 * (size - 1)}, kNumberHeight,
                     plot::Align::kCenter, dark ? plot::kPaper : plot::kInk);
    }
}

}  // namespace

bool HasCorrelationPicture(const uncertainty::Correlation& correlation) {
  return correlation.quantities.size() > 1 &&
         correlation.quantities.size() <= uncertainty::kMostCorrelated;
}

cv::Mat3b CorrelationPicture(const uncertainty::Correlation& correlation) {
  const Layout layout = LayoutOf(correlation);
  const int left = plot::kMargin + layout.longest + kLabelGap;
  const int width = left + layout.size + plot::kMargin + plot::kBarWidth + kBarLabels;
  const int least = 2 * plot::kMargin + plot::TextWidth(kTitle, plot::kCaption);
  cv::Mat3b page = plot::Page(std::max(width, least), plot::kTitleHeight + layout.size + kLabelGap +
                                                          layout.longest + plot::kMargin);
  plot::DrawTitle(page, plot::kMargin, kTitle);
  const cv::Rect area(left, plot::kTitleHeight, layout.size, layout.size);
  DrawSquares(page, layout, correlation.matrix, area.tl());
  DrawNames(page, layout, area.tl());
  plot::DrawScaleBeside(
      page, area, [](double t) { return plot::DivergingColour(2.0 * t - 1.0); },
      {{0.0, "-1"}, {0.25, "-0.5"}, {0.5, "0"}, {0.75, "+0.5"}, {1.0, "+1"}}, "");
  return page;
}

}  // namespace turnlight::estimator::pictures
