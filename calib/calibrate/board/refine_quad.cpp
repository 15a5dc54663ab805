#include "calib/calibrate/board/refine_quad.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include "calib/calibrate/board/saddle_points.h"

namespace turnlight::calib::calibrate::board {
namespace {

constexpr int kPlaces = 15;           // along a side
constexpr double kFirstPlace = 0.12;  // of it, from a corner
constexpr int kPasses =
    5;  // each from where the last one found it, so that the reach is even on both sides
constexpr double kStep = 0.25;       // pixels, across
constexpr double kLeastStep = 20.0;  // of 255 levels, from dark to bright

// How far the edge is from a point, along its normal: the mean place of the rise in level.
std::optional<double> EdgeAt(const cv::Mat& picture, const Eigen::Vector2d& point,
                             const Eigen::Vector2d& normal, double reach) {
  double rise = 0.0;
  double moment = 0.0;
  for (double s = -reach; s < reach - kStep / 2.0; s += kStep) {
    const double step =
        LevelAt(picture, point + (s + kStep) * normal) - LevelAt(picture, point + s * normal);
    rise += step;
    moment += step * (s + kStep / 2.0);
  }
  if (rise < kLeastStep) return std::nullopt;
  const double place = moment / rise;
  if (!(std::abs(place) < reach)) return std::nullopt;
  return place;
}

using Line = Eigen::Hyperplane<double, 2>;

std::optional<Line> SideLine(const cv::Mat& picture, const Eigen::Vector2d& p,
                             const Eigen::Vector2d& q, double reach) {
  const Eigen::Vector2d along = (q - p).normalized();
  // Corners go clockwise in a picture whose y points down: outside is to the left.
  const Eigen::Vector2d outwards(along.y(), -along.x());
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < kPlaces; ++i) {
    const double t = kFirstPlace + (1.0 - 2.0 * kFirstPlace) * i / (kPlaces - 1.0);
    const Eigen::Vector2d point = p + t * (q - p);
    if (const auto place = EdgeAt(picture, point, outwards, reach))
      points.push_back(point + *place * outwards);
  }
  if (points.size() < 2 * kPlaces / 3) return std::nullopt;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const auto& point : points) mean += point / static_cast<double>(points.size());
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const auto& point : points) scatter += (point - mean) * (point - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(scatter);
  return Line(solver.eigenvectors().col(0), mean);
}

}  // namespace

std::optional<Quad> RefineQuad(const cv::Mat& picture, const Quad& corners, double reach) {
  Quad refined = corners;
  for (int pass = 0; pass < kPasses; ++pass) {
    std::array<Line, 4> sides;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto side = SideLine(picture, refined[i], refined[(i + 1) % 4], reach);
      if (!side) return std::nullopt;
      sides[i] = *side;
    }
    Quad crossed;
    for (std::size_t i = 0; i < 4; ++i) {
      crossed[i] = sides[(i + 3) % 4].intersection(sides[i]);
      if (!((crossed[i] - corners[i]).norm() < reach + 2.0)) return std::nullopt;
    }
    refined = crossed;
  }
  return refined;
}

}  // namespace turnlight::calib::calibrate::board
