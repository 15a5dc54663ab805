// Proves: rays of a distant light and of a near one, exact and with noise, give the light and its
// covariance; what the views do not determine is not given. Coverage is the study's.
#include "calib/calibrate/probe/light_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "tests/calib/calibrate/probe/ball_pictures.h"

namespace turnlight::calib::calibrate::probe {
namespace {

using Eigen::Vector3d;

std::vector<Sighting> Seen(const BallStudio& studio, const Vector3d& u, double rho, double sigma) {
  const RandomStream random(11, 0);
  std::vector<Sighting> sightings;
  for (std::size_t i = 0; i < studio.views.size(); ++i) {
    const auto pixel = PixelOfLight(studio.views[i], u, rho);
    if (!pixel) continue;
    const Eigen::Vector2d noise(random.Normal(2 * i), random.Normal(2 * i + 1));
    sightings.push_back(
        {i, *pixel + sigma * noise, std::max(sigma * sigma, 1e-6) * Eigen::Matrix2d::Identity()});
  }
  return sightings;
}

BallPictures Around(int views) {
  BallPictures pictures;
  pictures.views = views;
  return pictures;
}

TEST(LightFit, ADistantLight) {
  const BallStudio studio(Around(8));
  const Vector3d u = Vector3d(0.3, -0.2, 0.9).normalized();
  const auto fit = FitLight(studio.views, Seen(studio, u, 0.0, 0.0), Vector3d::Zero(), false);
  ASSERT_TRUE(fit);
  EXPECT_NEAR((fit->u - u).norm(), 0.0, 1e-7);
  EXPECT_EQ(fit->rho, 0.0);
  EXPECT_EQ(fit->freedom, 14);
}

TEST(LightFit, ANearLightAboutAnyPoint) {
  const BallStudio studio(Around(8));
  const Vector3d position(200.0, -300.0, 600.0), reference(5.0, 10.0, -20.0);
  const auto fit =
      FitLight(studio.views, Seen(studio, position.normalized(), 1.0 / position.norm(), 0.0),
               reference, true);
  ASSERT_TRUE(fit);
  EXPECT_NEAR((reference + fit->u / fit->rho - position).norm(), 0.0, 1e-3);
}

TEST(LightFit, NoiseStaysWithinItsSigmas) {
  const BallStudio studio(Around(12));
  const Vector3d position(200.0, -300.0, 600.0);
  const auto fit =
      FitLight(studio.views, Seen(studio, position.normalized(), 1.0 / position.norm(), 0.03),
               Vector3d::Zero(), true);
  ASSERT_TRUE(fit);
  const double rho = 1.0 / position.norm();
  EXPECT_LT(std::abs(fit->rho - rho), 4.0 * std::sqrt(fit->covariance(2, 2)));
  EXPECT_GT(rho, 10.0 * std::sqrt(fit->covariance(2, 2)));
  EXPECT_LT((fit->u - position.normalized()).norm(),
            4.0 * std::sqrt(fit->covariance.topLeftCorner<2, 2>().trace()));
  EXPECT_LT(fit->chi_squared / fit->freedom, 2.5);
}

TEST(LightFit, OneViewDoesNotTellTheDistance) {
  const BallStudio studio(Around(1));
  const auto seen = Seen(studio, Vector3d(0.5, 0.1, 0.8).normalized(), 0.0, 0.0);
  EXPECT_TRUE(FitLight(studio.views, seen, Vector3d::Zero(), false));
  EXPECT_FALSE(FitLight(studio.views, seen, Vector3d::Zero(), true));
}

TEST(LightFit, ViewsOfTheSameDoNotEither) {
  BallPictures pictures = Around(6);
  pictures.arc_deg = 0.0;
  const BallStudio studio(pictures);
  const auto seen = Seen(studio, Vector3d(0.5, 0.1, 0.8).normalized(), 0.0, 0.0);
  const auto fit = FitLight(studio.views, seen, Vector3d::Zero(), true);
  if (fit) {
    EXPECT_LT(std::abs(fit->rho), 3.0 * std::sqrt(fit->covariance(2, 2)));
  }
}

TEST(LightFit, ASpotBesideTheBallIsRefused) {
  const BallStudio studio(Around(1));
  EXPECT_FALSE(FitLight(studio.views, {{0, {2.0, 2.0}, Eigen::Matrix2d::Identity()}},
                        Vector3d::Zero(), false));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::probe
