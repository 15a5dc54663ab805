// Proves: the level is a power of two that brings any brightness to about 1 and leaves what was
// exposed well alone; scaling an estimate scales what is in radiance, with its sigmas, and nothing
// else. Does not prove that an estimate at a level is the same (unknown_errors_test).
#include "estimator/exposure_level.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/estimator/random_observations.h"

namespace turnlight::estimator {
namespace {

using Eigen::Vector3d;

TEST(ExposureLevel, BringsAnyBrightnessToAboutOne) {
  for (double brightest = 1e-6; brightest < 1e6; brightest *= 1.7) {
    const double level = ExposureLevel(brightest);
    EXPECT_EQ(std::exp2(std::round(std::log2(level))), level) << "exact in every float";
    if (brightest > 0.02 && brightest < 50.0) {
      EXPECT_EQ(level, 1.0);
    } else {
      EXPECT_LE(std::abs(std::log2(brightest / level)), 0.5 + 1e-12);
    }
  }
}

TEST(Scale, MultipliesEveryRadiance) {
  observe::Observations all = RandomObservations(300, 3, 1).observations;
  const observe::Observations before = all;
  Scale(all, 0.25);
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < all.size(); ++i)
      EXPECT_EQ(all.radiance[c][i], 0.25f * before.radiance[c][i]);
  EXPECT_EQ(all.position, before.position);
}

// The model is linear in what Scale touches.
TEST(Scale, AReflectanceShowsThePictureTimesTheFactor) {
  model::Scene scene = TwoLights();
  scene.reflectance.diffuse_model = model::DiffuseModel::kOrenNayar;
  scene.reflectance.roughness = 0.3;
  model::Scene scaled = scene;
  Scale(scaled.reflectance, 8.0);
  const RandomObservations random(50, 3, 1);
  for (const RandomPoint& p : random.points)
    EXPECT_LT((model::Shade(scaled, p.position, p.normal, p.viewer) -
               8.0 * model::Shade(scene, p.position, p.normal, p.viewer))
                  .norm(),
              1e-14);
}

TEST(Scale, AnEstimateKeepsWhatIsNoRadiance) {
  Estimate estimate;
  LightEstimate& light = estimate.lights.emplace_back();
  light.direction_sigma = light.inverse_distance_sigma = 1.0;
  light.intensity_sigma = 1.0;
  light.diffuse_product = light.diffuse_product_sigma = Vector3d::Ones();
  light.specular_product = light.specular_product_sigma = 1.0;
  uncertainty::LightSigma& stat = estimate.stat.lights.emplace_back();
  stat.direction = stat.intensity = stat.specular_product = 1.0;
  stat.diffuse_product = Vector3d::Ones();
  estimate.reflectance = {Vector3d::Ones(), 1.0, 1.0, 1.0, 1.0};
  estimate.sigma = {Vector3d::Ones(), 1.0, 1.0, 1.0, 1.0, 1.0};
  estimate.stat.albedo = estimate.stat.ambient_product = Vector3d::Ones();
  estimate.stat.ambient = estimate.stat.diffuse = estimate.stat.lobes[0].strength = 1.0;
  estimate.stat.lobes[0].shape = 1.0;
  estimate.ambient_product = estimate.ambient_product_sigma = Vector3d::Ones();
  estimate.initial_rms = estimate.rms = estimate.condition = 1.0;
  estimate.history = {{0, 1.0}};
  Scale(estimate, 4.0);
  for (const double scaled : {light.diffuse_product[1],
                              light.diffuse_product_sigma[2],
                              light.specular_product,
                              light.specular_product_sigma,
                              stat.diffuse_product[0],
                              stat.specular_product,
                              estimate.reflectance.ambient,
                              estimate.reflectance.diffuse,
                              estimate.reflectance.lobes[0].strength,
                              estimate.sigma.ambient,
                              estimate.sigma.diffuse,
                              estimate.sigma.lobes[0].strength,
                              estimate.stat.ambient,
                              estimate.stat.diffuse,
                              estimate.stat.lobes[0].strength,
                              estimate.stat.ambient_product[0],
                              estimate.ambient_product[1],
                              estimate.ambient_product_sigma[2],
                              estimate.initial_rms,
                              estimate.rms,
                              estimate.history[0].rms})
    EXPECT_EQ(scaled, 4.0);
  for (const double same :
       {light.light.intensity, *light.intensity_sigma, light.direction_sigma,
        light.inverse_distance_sigma, stat.direction, stat.intensity,
        estimate.reflectance.albedo[0], estimate.reflectance.lobes[0].shape,
        estimate.sigma.albedo[0], *estimate.sigma.lobes[0].shape, *estimate.sigma.roughness,
        estimate.stat.albedo[0], estimate.stat.lobes[0].shape, estimate.condition})
    EXPECT_EQ(same, 1.0);
}

}  // namespace
}  // namespace turnlight::estimator
