#include "calib/calibrate/board/refine_corners.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calib/calibrate/board/homography.h"

namespace turnlight::calib::calibrate::board {
namespace {

// Of the reach: half a window's side; its diagonal and the gradient's own width stay within.
constexpr double kWindow = 0.55;
constexpr int kLeastWindow = 2;
constexpr int kLargestWindow = 12;    // more averages over the lens's bend rather than noise
constexpr double kLedAway = 0.35;     // of the reach
constexpr double kOutlier = 6.0;      // robust sigmas,
constexpr double kWaves = 0.03;       // nor than so much of the step between points,
constexpr double kAlwaysGood = 0.75;  // but never less than so many pixels

// The step to the next corner in a direction, from both sides where both are there.
Eigen::Vector2d Step(const CornerLattice& lattice, int column, int row, int dx, int dy) {
  const Eigen::Vector2d& here = lattice.At(column, row);
  Eigen::Vector2d shortest = Eigen::Vector2d::Zero();
  for (const int sign : {1, -1}) {
    if (!lattice.Has(column + sign * dx, row + sign * dy)) continue;
    const Eigen::Vector2d step = lattice.At(column + sign * dx, row + sign * dy) - here;
    if (shortest.isZero() || step.squaredNorm() < shortest.squaredNorm()) shortest = step;
  }
  return shortest;
}

// Terms of a polynomial of place: of the third degree, or of the fourth.
Eigen::RowVectorXd PolynomialTerms(const Eigen::Vector2d& p, int degree) {
  const double x = p.x(), y = p.y();
  Eigen::RowVectorXd terms(15);
  terms << 1, x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y, x * x * x * x,
      x * x * x * y, x * x * y * y, x * y * y * y, y * y * y * y;
  return terms.head(degree == 3 ? 10 : 15);
}

// Moved and scaled into -1..1, which keeps a polynomial's terms apart.
std::vector<Eigen::Vector2d> Normalised(const std::vector<Eigen::Vector2d>& places) {
  Eigen::AlignedBox2d box;
  for (const auto& place : places) box.extend(place);
  const double half = std::max(box.sizes().maxCoeff() / 2.0, 1e-12);
  std::vector<Eigen::Vector2d> normalised;
  for (const auto& place : places) normalised.push_back((place - box.center()) / half);
  return normalised;
}

struct PlaneFit {
  std::vector<Eigen::Vector2d> places, pixels;
  std::vector<double> weights;

  // Pixels each corner is off the fit; nothing where there is none.
  std::optional<std::vector<double>> Misfits() const;
};

std::optional<std::vector<double>> PlaneFit::Misfits() const {
  const auto homography = FitHomography(places, pixels, weights);
  if (!homography) return std::nullopt;
  const auto count = static_cast<Eigen::Index>(places.size());
  Eigen::MatrixXd off(count, 2);
  for (Eigen::Index i = 0; i < count; ++i)
    off.row(i) = (pixels[static_cast<std::size_t>(i)] -
                  Map(*homography, places[static_cast<std::size_t>(i)]))
                     .transpose();
  constexpr Eigen::Index kEnoughForThree = 20;
  constexpr Eigen::Index kEnoughForFour = 40;
  if (count >= kEnoughForThree) {
    const int degree = count >= kEnoughForFour ? 4 : 3;
    Eigen::MatrixXd terms(count, degree == 3 ? 10 : 15);
    Eigen::VectorXd roots(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      terms.row(i) = PolynomialTerms(places[static_cast<std::size_t>(i)], degree);
      roots[i] = std::sqrt(weights[static_cast<std::size_t>(i)]);
    }
    const Eigen::MatrixXd lens =
        (roots.asDiagonal() * terms).colPivHouseholderQr().solve(roots.asDiagonal() * off);
    off -= terms * lens;
  }
  std::vector<double> misfits;
  for (Eigen::Index i = 0; i < count; ++i) misfits.push_back(off.row(i).norm());
  return misfits;
}

double RobustSigma(std::vector<double> misfits) {
  const auto middle = misfits.begin() + static_cast<std::ptrdiff_t>(misfits.size() / 2);
  std::nth_element(misfits.begin(), middle, misfits.end());
  return *middle / 1.177;  // the median of a Rayleigh distribution
}

}  // namespace

std::optional<Eigen::Vector2d> RefineCorner(const cv::Mat& picture, const Eigen::Vector2d& corner,
                                            double reach) {
  const int half = std::clamp(static_cast<int>(kWindow * reach), kLeastWindow, kLargestWindow);
  if (corner.x() < half + 2 || corner.y() < half + 2 || corner.x() > picture.cols - half - 3 ||
      corner.y() > picture.rows - half - 3)
    return std::nullopt;
  // The corner's surroundings, blurred so that gradients between pixels are not aliased: this
  // halves the error in a sharp picture. Little room stands little blur.
  const double blur = std::clamp(reach / 6.0, 0.6, 1.0);
  const int side = half + 8;
  const cv::Rect box = cv::Rect(static_cast<int>(corner.x()) - side,
                                static_cast<int>(corner.y()) - side, 2 * side + 1, 2 * side + 1) &
                       cv::Rect(0, 0, picture.cols, picture.rows);
  cv::Mat patch;
  cv::GaussianBlur(picture(box), patch, {}, blur, blur, cv::BORDER_REPLICATE);
  std::vector<cv::Point2f> points{
      {static_cast<float>(corner.x() - box.x), static_cast<float>(corner.y() - box.y)}};
  cv::cornerSubPix(patch, points, {half, half}, {-1, -1},
                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 60, 1e-3});
  const Eigen::Vector2d refined =
      Eigen::Vector2d(points[0].x, points[0].y) + Eigen::Vector2d(box.x, box.y);
  if (!((refined - corner).norm() <= std::max(1.5, kLedAway * reach))) return std::nullopt;
  return refined;
}

double FreeReach(const CornerLattice& lattice, int column, int row) {
  const Eigen::Vector2d along = Step(lattice, column, row, 1, 0);
  const Eigen::Vector2d down = Step(lattice, column, row, 0, 1);
  if (along.isZero() || down.isZero()) return 0.0;
  return std::abs(along.x() * down.y() - along.y() * down.x()) /
         std::max(along.norm(), down.norm());
}

void RefineCorners(const cv::Mat& picture, CornerLattice& lattice) {
  const CornerLattice rough = lattice;
  for (int row = 0; row < rough.rows; ++row)
    for (int column = 0; column < rough.columns; ++column) {
      if (!rough.Has(column, row)) continue;
      const double reach = FreeReach(rough, column, row);
      lattice.corners[lattice.Index(column, row)] =
          RefineCorner(picture, rough.At(column, row), reach);
    }
}

std::vector<bool> Regular(const std::vector<Eigen::Vector2d>& places,
                          const std::vector<Eigen::Vector2d>& pixels, double step) {
  std::vector<bool> regular(places.size(), true);
  if (places.empty()) return regular;
  PlaneFit fit{Normalised(places), pixels, std::vector<double>(places.size(), 1.0)};
  std::vector<double> misfits;
  double sigma = 0.0;
  for (int round = 0; round < 6; ++round) {
    const auto found = fit.Misfits();
    if (!found) return regular;
    misfits = *found;
    sigma = std::max(RobustSigma(misfits), 0.02);
    for (std::size_t i = 0; i < misfits.size(); ++i) {
      const double ratio = misfits[i] / (3.0 * sigma);  // Cauchy's weight
      fit.weights[i] = 1.0 / (1.0 + ratio * ratio);
    }
  }
  for (std::size_t i = 0; i < misfits.size(); ++i)
    regular[i] = misfits[i] <= std::max({kAlwaysGood, kWaves * step, kOutlier * sigma});
  return regular;
}

void DropOutliers(CornerLattice& lattice) {
  std::vector<std::size_t> corners;
  std::vector<double> steps;
  std::vector<Eigen::Vector2d> places, pixels;
  for (int row = 0; row < lattice.rows; ++row)
    for (int column = 0; column < lattice.columns; ++column) {
      if (!lattice.Has(column, row)) continue;
      corners.push_back(lattice.Index(column, row));
      steps.push_back(FreeReach(lattice, column, row));
      places.emplace_back(column, row);
      pixels.push_back(lattice.At(column, row));
    }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const auto regular = Regular(places, pixels, steps.empty() ? 0.0 : *middle);
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (!regular[i]) lattice.corners[corners[i]].reset();
}

}  // namespace turnlight::calib::calibrate::board
