#include "calib/calibrate/board/view_quality.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "calib/calibrate/board/picture_levels.h"
#include "calib/calibrate/board/saddle_points.h"

namespace turnlight::calib::calibrate::board {
namespace {

constexpr double kProfileStep = 0.25;  // pixels

// contrast / (sqrt(2 pi) steepest slope)
double SigmaAcross(const cv::Mat& picture, const PrintEdge& edge) {
  const Eigen::Vector2d along = edge.q - edge.p;
  const Eigen::Vector2d across = Eigen::Vector2d(-along.y(), along.x()).normalized();
  const auto level = [&](double s) {
    double sum = 0.0;  // along the edge, against noise
    for (const double t : {0.4, 0.45, 0.5, 0.55, 0.6})
      sum += LevelAt(picture, edge.p + t * along + s * across) / 5.0;
    return sum;
  };
  const double contrast = std::abs(level(edge.reach) - level(-edge.reach));
  double steepest = 0.0;
  for (double s = -edge.reach; s < edge.reach; s += kProfileStep)
    steepest = std::max(steepest, std::abs(level(s + 0.5) - level(s - 0.5)));
  return steepest > 0.0 ? contrast / (std::sqrt(2.0 * std::numbers::pi) * steepest) : 0.0;
}

}  // namespace

std::vector<PrintEdge> EdgesOf(const CornerLattice& lattice, double share) {
  std::vector<PrintEdge> edges;
  for (int row = 0; row < lattice.rows; ++row)
    for (int column = 0; column < lattice.columns; ++column) {
      if (!lattice.Has(column, row) || !lattice.Has(column + 1, row) ||
          !lattice.Has(column, row + 1))
        continue;
      const auto& here = lattice.At(column, row);
      const auto& right = lattice.At(column + 1, row);
      const auto& below = lattice.At(column, row + 1);
      const Eigen::Vector2d along = right - here, down = below - here;
      const double area = std::abs(along.x() * down.y() - along.y() * down.x());
      edges.push_back({here, right, share * area / along.norm()});
      edges.push_back({here, below, share * area / down.norm()});
    }
  return edges;
}

double EdgeSigma(const cv::Mat& picture, const std::vector<PrintEdge>& edges) {
  std::vector<double> sigmas;
  for (const PrintEdge& edge : edges) sigmas.push_back(SigmaAcross(picture, edge));
  if (sigmas.empty()) return 0.0;
  const auto middle = sigmas.begin() + static_cast<std::ptrdiff_t>(sigmas.size() / 2);
  std::nth_element(sigmas.begin(), middle, sigmas.end());
  return *middle;
}

double SaturatedShare(const cv::Mat& picture, const cv::Mat& levelled, const BoardView& view) {
  const double limit = SaturationLevel(picture);
  std::vector<cv::Point2f> points;
  for (const SeenPoint& seen : view.points)
    points.emplace_back(static_cast<float>(seen.pixel.x()), static_cast<float>(seen.pixel.y()));
  if (points.size() < 3 || !std::isfinite(limit)) return 0.0;
  std::vector<cv::Point2f> hull;
  cv::convexHull(points, hull);
  std::vector<cv::Point> outline(hull.begin(), hull.end());
  cv::Mat inside = cv::Mat::zeros(picture.size(), CV_8U);
  cv::fillConvexPoly(inside, outline, 255);
  constexpr double kBright = 128.0;  // half way between the levelled picture's ends
  const cv::Mat bright = inside & (levelled > kBright);
  const int all = cv::countNonZero(bright);
  return all > 0 ? static_cast<double>(cv::countNonZero(bright & (picture >= limit))) / all : 0.0;
}

}  // namespace turnlight::calib::calibrate::board
