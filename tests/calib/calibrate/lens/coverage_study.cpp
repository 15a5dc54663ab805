// Proves: over 200 draws of the corners' noise the true projection of 9 pixels lies within the
// stated ellipses of 1 and 2 sigma as often as it should, 39.3 % and 86.5 % of the draws.
// A study: ctest -L study.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>

#include "calib/calibrate/lens/projection_difference.h"
#include "simulated_views.h"

namespace turnlight::calib::calibrate::lens {
namespace {

constexpr int kDraws = 200;
// Binomial 99 % for 9 pixels together: each pixel's two tails have 0.01 / 9.
constexpr double kBand = 3.26;

// Where the calibrated lens puts the direction that the true lens sees in a pixel, once held fixed
// to the boards as the uncertainty wants it: the mean of the boards' motion in C is taken off.
Eigen::Matrix3d MeanRotation(const LensCalibration& found, const LensCalibration& truth) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < found.views.size(); ++i)
    sum += found.views[i].X_CB.rotation * truth.views[i].X_CB.rotation.transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

TEST(LensCoverageStudy, EllipsesHoldWhatTheyPromise) {
  const CameraModel camera = ExampleLens();
  const board::Board board = ExampleBoard();
  SimulatedViews how;
  how.noise_px = 0.0;
  LensOptions options;
  options.rejects_outliers = false;
  const auto truth = CalibrateLens(board, SimulateViews(camera, board, how), options);
  ASSERT_TRUE(truth) << truth.error().text;
  std::vector<Eigen::Vector2d> pixels;
  for (const double y : {100.0, 700.0, 1300.0})
    for (const double x : {150.0, 1000.0, 1850.0}) pixels.emplace_back(x, y);
  const auto rays = truth->camera().Unproject(pixels);
  std::vector<int> within_one(9, 0), within_two(9, 0);
  how.noise_px = 0.3;
  options.rejects_outliers = true;
  for (int draw = 0; draw < kDraws; ++draw) {
    how.noise_seed = 1000 + static_cast<std::uint64_t>(draw);
    const auto found = CalibrateLens(board, SimulateViews(camera, board, how), options);
    ASSERT_TRUE(found) << found.error().text;
    ASSERT_EQ(found->views.size(), truth->views.size());
    const Eigen::Matrix3d rotation = MeanRotation(*found, *truth);
    std::vector<Eigen::Vector3d> turned;
    for (const Eigen::Vector3d& ray : rays) turned.push_back(rotation * ray);
    const auto there = found->camera().Project(turned);
    const auto covariance = found->uncertainty.At(pixels);
    for (std::size_t i = 0; i < 9; ++i) {
      const Eigen::Vector2d miss = there[i] - pixels[i];
      const double squared = miss.dot(covariance[i].inverse() * miss);
      within_one[i] += squared < 1.0;
      within_two[i] += squared < 4.0;
    }
  }
  for (std::size_t i = 0; i < 9; ++i) {
    std::printf("pixel (%g, %g): %.1f %% within 1 sigma, %.1f %% within 2\n", pixels[i].x(),
                pixels[i].y(), 100.0 * within_one[i] / kDraws, 100.0 * within_two[i] / kDraws);
    for (const auto& [count, share] : {std::pair{within_one[i], 1.0 - std::exp(-0.5)},
                                       std::pair{within_two[i], 1.0 - std::exp(-2.0)}})
      EXPECT_NEAR(static_cast<double>(count) / kDraws, share,
                  kBand * std::sqrt(share * (1.0 - share) / kDraws))
          << "pixel " << i;
  }
}

}  // namespace
}  // namespace turnlight::calib::calibrate::lens
