#include "calib/calibrate/board/view_quality.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "calib/calibrate/board/saddle_points.h"

namespace turnlight::calib::calibrate::board {
namespace {

constexpr double kProfileStep = 0.25;  // pixels
constexpr double kProfileReach = 0.35;  // of the squares' width, to both sides

// Sigma of the edge between two corners: contrast / (sqrt(2 pi) steepest slope).
double SigmaAcross(const cv::Mat& picture, const Eigen::Vector2d& p, const Eigen::Vector2d& q,
                   double width) {
  const Eigen::Vector2d along = q - p;
  const Eigen::Vector2d across = Eigen::Vector2d(-along.y(), along.x()).normalized();
  const double reach = kProfileReach * width;
  const auto level = [&](double s) {
    double sum = 0.0;  // along the edge, against noise
    for (const double t : {0.4, 0.45, 0.5, 0.55, 0.6})
      sum += LevelAt(picture, p + t * along + s * across) / 5.0;
    return sum;
  };
  const double contrast = std::abs(level(reach) - level(-reach));
  double steepest = 0.0;
  for (double s = -reach; s < reach; s += kProfileStep)
    steepest = std::max(steepest, std::abs(level(s + 0.5) - level(s - 0.5)));
  return steepest > 0.0 ? contrast / (std::sqrt(2.0 * std::numbers::pi) * steepest) : 0.0;
}

}  // namespace

double EdgeSigma(const cv::Mat& picture, const CornerLattice& lattice) {
  std::vector<double> sigmas;
  for (int row = 0; row < lattice.rows; ++row)
    for (int column = 0; column < lattice.columns; ++column) {
      if (!lattice.Has(column, row)) continue;
      if (lattice.Has(column + 1, row) && lattice.Has(column, row + 1)) {
        const auto& here = lattice.At(column, row);
        const auto& right = lattice.At(column + 1, row);
        const auto& below = lattice.At(column, row + 1);
        const Eigen::Vector2d along = right - here, down = below - here;
        const double area = std::abs(along.x() * down.y() - along.y() * down.x());
        sigmas.push_back(SigmaAcross(picture, here, right, area / along.norm()));
        sigmas.push_back(SigmaAcross(picture, here, below, area / down.norm()));
      }
    }
  if (sigmas.empty()) return 0.0;
  const auto middle = sigmas.begin() + static_cast<std::ptrdiff_t>(sigmas.size() / 2);
  std::nth_element(sigmas.begin(), middle, sigmas.end());
  return *middle;
}

double SaturatedShare(const cv::Mat& picture, const CornerLattice& lattice, double level) {
  int squares = 0;
  int saturated = 0;
  for (int row = 0; row + 1 < lattice.rows; ++row)
    for (int column = 0; column + 1 < lattice.columns; ++column) {
      if (((column + row) % 2 == 0) == lattice.begins_dark) continue;
      if (!lattice.Has(column, row) || !lattice.Has(column + 1, row + 1)) continue;
      const Eigen::Vector2d middle =
          (lattice.At(column, row) + lattice.At(column + 1, row + 1)) / 2.0;
      const int x = std::clamp(static_cast<int>(std::lround(middle.x())), 0, picture.cols - 1);
      const int y = std::clamp(static_cast<int>(std::lround(middle.y())), 0, picture.rows - 1);
      const double value = picture.depth() == CV_8U ? picture.at<std::uint8_t>(y, x)
                                                    : picture.at<std::uint16_t>(y, x);
      ++squares;
      saturated += value >= level;
    }
  return squares > 0 ? static_cast<double>(saturated) / squares : 0.0;
}

}  // namespace turnlight::calib::calibrate::board
