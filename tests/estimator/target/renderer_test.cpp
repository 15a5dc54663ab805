// Proves: a picture is the scene model's shade where one ray is taken, and converges on the mean
// over the pixel with more; coverage sums up to the target's outline; under ambient light alone all
// is as bright as the albedo; lights behind a wall are dark, or not, as asked. Does not prove the
// scene model itself (scene_test), nor agreement with other renderers (independent_data_test).
#include "estimator/target/renderer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/estimator/floor_and_wall.h"
#include "tests/estimator/random_observations.h"
#include "tests/estimator/tiny_ball.h"

namespace turnlight::estimator::target {
namespace {

using Eigen::Vector3d;

TEST(Render, OneRayIsTheShadeOfItsPoint) {
  const TinyBall ball(TwoLights(), 0);
  const calib::Pose X_WC = LookingAtOrigin({5.0, -4.0, 3.0});
  const Rendering picture =
      Render(TwoLights(), ball.geometry, ball.rays, X_WC, {}, {.samples_per_side = 1});
  int seen = 0;
  for (int row = 0; row < 48; ++row)
    for (int column = 0; column < 64; ++column) {
      const Vector3d ray = X_WC.rotation * ball.rays.Ray(column, row);
      const auto hit = ball.geometry.Intersect(X_WC.translation, ray);
      ASSERT_EQ(picture.coverage(row, column), hit ? 1.0f : 0.0f);
      const Vector3d expected =
          hit ? model::Shade(TwoLights(), hit->position, hit->normal, -ray) : Vector3d::Zero();
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(picture.radiance(row, column)[c], expected[c], 1e-6 * (1.0 + expected[c]));
      seen += hit ? 1 : 0;
    }
  EXPECT_GT(seen, 1000);
}

// A sphere of angular radius a, seen in the middle, covers pi (f tan a)^2 pixels.
TEST(Render, CoverageIsTheOutlinesArea) {
  const TinyBall ball(TwoLights(), 0);
  const Rendering picture = Render(TwoLights(), ball.geometry, ball.rays,
                                   LookingAtOrigin({8.4, 0, 0}), {}, {.samples_per_side = 8});
  const double radius = 160.0 * std::tan(std::asin(1.0 / 8.4));
  EXPECT_NEAR(cv::sum(picture.coverage)[0], M_PI * radius * radius, 1.5);
}

TEST(Render, AmbientLightShowsTheAlbedo) {
  model::Scene scene;
  scene.reflectance.albedo = {0.8, 0.4, 0.2};
  scene.reflectance.ambient = 0.5;
  const TinyBall ball(scene, 0);
  const Rendering picture =
      Render(scene, ball.geometry, ball.rays, LookingAtOrigin({8.4, 0, 0}), {});
  for (int row = 0; row < 48; ++row)
    for (int column = 0; column < 64; ++column) {
      const float covered = picture.coverage(row, column);
      const cv::Vec3f& pixel = picture.radiance(row, column);
      EXPECT_NEAR(pixel[0], 0.4f * covered, 1e-6f);
      EXPECT_NEAR(pixel[2], 0.1f * covered, 1e-6f);
    }
}

// A highlight narrower than a pixel: the centre sees none of it or all, the mean what it is.
TEST(Render, MoreRaysConvergeOnTheMean) {
  model::Scene scene = TwoLights();
  scene.reflectance.lobes[0].shape = 3000.0;
  const TinyBall ball(scene, 0);
  const calib::Pose X_WC = LookingAtOrigin({3.0, 2.0, 8.0});
  const auto brightest = [&](int samples) {
    double most = 0.0;
    const Rendering picture =
        Render(scene, ball.geometry, ball.rays, X_WC, {}, {.samples_per_side = samples});
    for (const cv::Vec3f& pixel : picture.radiance) most = std::max<double>(most, pixel[0]);
    return most;
  };
  const double fine = brightest(32);
  EXPECT_GT(std::abs(brightest(1) - fine), 0.01);
  EXPECT_LT(std::abs(brightest(8) - fine), 0.004);
}

TEST(Render, TheTargetsPoseIsThatOfItsFrame) {
  const TinyBall ball(TwoLights(), 0);
  calib::Pose X_WT;
  X_WT.translation = {0.0, 0.0, 0.1};
  const Rendering picture =
      Render(TwoLights(), ball.geometry, ball.rays, LookingAtOrigin({8.4, 0, 0}), X_WT);
  double row_sum = 0.0;
  for (int row = 0; row < 48; ++row) row_sum += row * cv::sum(picture.coverage.row(row))[0];
  const double mean_row = row_sum / cv::sum(picture.coverage)[0];
  EXPECT_NEAR(mean_row, 23.5 - 160.0 * 0.1 / 8.4, 0.1) << "up in W is up in the picture";
}

TEST(Render, AWallKeepsItsLightOffTheFloorIfShadowsAreCast) {
  const Geometry mesh{calib::TargetShape(FloorAndWall())};
  const calib::CameraModel camera = calib::CameraModel::Pinhole(64, 48, 160.0, 160.0, 31.5, 23.5);
  const calib::RayGrid rays(camera);
  model::Scene scene;
  scene.lights = {{Vector3d(0, 1, 1).normalized(), 0.0, 1.0, Vector3d::Ones()}};
  const calib::Pose X_WC = LookingAtOrigin({0.0, -150.0, 200.0});
  for (const bool shadows : {true, false}) {
    const Rendering picture =
        Render(scene, mesh, rays, X_WC, {}, {.samples_per_side = 1, .cast_shadows = shadows});
    for (int row = 0; row < 48; ++row) {
      const Vector3d ray = X_WC.rotation * rays.Ray(32, row);
      const auto hit = mesh.Intersect(X_WC.translation, ray);
      if (!hit || hit->position.z() > 1e-6 || std::abs(hit->position.y() - 10.0) < 0.1) continue;
      const bool dark = shadows && hit->position.y() > 10.0 && hit->position.y() < 20.0;
      EXPECT_NEAR(picture.radiance(row, 32)[0], dark ? 0.0 : std::sqrt(0.5), 1e-6);
    }
  }
}

}  // namespace
}  // namespace turnlight::estimator::target
