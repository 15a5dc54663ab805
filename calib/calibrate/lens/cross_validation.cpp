#include "calib/calibrate/lens/cross_validation.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "base/format.h"

namespace turnlight::calib::calibrate::lens {
namespace {

constexpr std::size_t kLeastPictures = 6;

std::array<std::vector<PictureViews>, 2> Halves(const std::vector<PictureViews>& pictures,
                                                const LensCalibration& calibration) {
  std::array<std::vector<PictureViews>, 2> halves;
  std::size_t count = 0;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    PictureViews used{pictures[i].picture, pictures[i].width, pictures[i].height, {}, ""};
    for (const FittedView& view : calibration.views)
      if (view.picture == i) used.boards.push_back(pictures[i].boards[view.board]);
    if (!used.boards.empty()) halves[count++ % 2].push_back(std::move(used));
  }
  return halves;
}

// The rms that noise lets expect of the differences, once a rotation has been fitted and taken off.
double ExpectedRms(const LensCalibration& first, const LensCalibration& second,
                   const std::vector<Eigen::Vector2d>& pixels, const std::vector<double>& weights) {
  const Eigen::MatrixXd derivatives = PixelDerivatives(first.camera(), pixels);
  const Eigen::Index intrinsics = derivatives.cols() - 3;
  const Eigen::MatrixXd covariance =
      (first.uncertainty.covariance() + second.uncertainty.covariance())
          .topLeftCorner(intrinsics, intrinsics);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
  const Eigen::MatrixXd moves = derivatives.leftCols(intrinsics) * solver.eigenvectors() *
                                solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  const Eigen::MatrixXd turns = derivatives.rightCols<3>();
  Eigen::VectorXd weight(derivatives.rows());
  for (Eigen::Index i = 0; i < weight.size(); ++i)
    weight[i] = weights[static_cast<std::size_t>(i) / 2];
  const Eigen::MatrixXd weighted = weight.asDiagonal() * turns;
  const Eigen::MatrixXd left =
      moves - turns * (turns.transpose() * weighted).ldlt().solve(weighted.transpose() * moves);
  return std::sqrt(left.squaredNorm() / static_cast<double>(pixels.size()));
}

std::vector<double> Weights(const std::vector<Eigen::Matrix2d>& a,
                            const std::vector<Eigen::Matrix2d>& b,
                            const std::vector<bool>& compared) {
  std::vector<double> weights;
  for (std::size_t i = 0; i < a.size(); ++i) {
    // As mrcal weighs: its square of the inverse product discounts uncertain regions.
    const double product = WorstSigma(a[i]) * WorstSigma(b[i]);
    weights.push_back(compared[i] ? 1.0 / (product * product) : 0.0);
  }
  return weights;
}

}  // namespace

std::vector<bool> CoveredPixels(const LensCalibration& calibration,
                                const std::vector<Eigen::Vector2d>& pixels) {
  std::vector<std::vector<cv::Point2f>> outlines(calibration.views.size());
  for (const FittedPoint& point : calibration.points)
    if (!point.outlier)
      outlines[point.view].emplace_back(static_cast<float>(point.pixel.x()),
                                        static_cast<float>(point.pixel.y()));
  std::vector<bool> covered(pixels.size(), false);
  for (std::vector<cv::Point2f>& outline : outlines) {
    if (outline.size() < 3) continue;
    std::vector<cv::Point2f> hull;
    cv::convexHull(outline, hull);
    for (std::size_t i = 0; i < pixels.size(); ++i)
      if (!covered[i])
        covered[i] =
            cv::pointPolygonTest(
                hull, {static_cast<float>(pixels[i].x()), static_cast<float>(pixels[i].y())},
                false) >= 0.0;
  }
  return covered;
}

Result<CrossValidation> CompareHalves(const board::Board& board,
                                      const std::vector<PictureViews>& pictures,
                                      const LensCalibration& calibration,
                                      const LensOptions& options, const ImageGrid& grid) {
  const auto halves = Halves(pictures, calibration);
  const std::size_t used = halves[0].size() + halves[1].size();
  if (used < kLeastPictures)
    return InputError(
        Format("%zu pictures were used, two halves need at least %zu", used, kLeastPictures));
  const auto first = CalibrateLens(board, halves[0], options);
  const auto second = CalibrateLens(board, halves[1], options);
  for (const auto* half : {&first, &second})
    if (!*half) return InputError("a half of the pictures is not enough: " + half->error().text);
  CrossValidation result;
  const auto in_first = CoveredPixels(*first, grid.pixels);
  const auto in_second = CoveredPixels(*second, grid.pixels);
  for (std::size_t i = 0; i < grid.pixels.size(); ++i)
    result.compared.push_back(in_first[i] && in_second[i]);
  const auto sigma_first = first->uncertainty.At(grid.pixels);
  const auto sigma_second = second->uncertainty.At(grid.pixels);
  const auto weights = Weights(sigma_first, sigma_second, result.compared);
  auto difference = ProjectionDifference(first->camera(), second->camera(), grid.pixels, weights);
  if (!difference) return InputError("the halves hardly cover a common area");
  result.difference = std::move(difference->px);
  std::vector<Eigen::Vector2d> pixels;
  std::vector<double> weights_there;
  double squares = 0.0;
  for (std::size_t i = 0; i < grid.pixels.size(); ++i) {
    const double length = result.difference[i].norm();
    result.compared[i] = result.compared[i] && std::isfinite(length) && std::isfinite(weights[i]);
    if (!result.compared[i]) continue;
    pixels.push_back(grid.pixels[i]);
    weights_there.push_back(weights[i]);
    squares += length * length;
    result.largest_px = std::max(result.largest_px, length);
  }
  if (pixels.empty()) return InputError("the halves cover no common area");
  result.rms_px = std::sqrt(squares / static_cast<double>(pixels.size()));
  result.expected_px = ExpectedRms(*first, *second, pixels, weights_there);
  return result;
}

}  // namespace turnlight::calib::calibrate::lens
