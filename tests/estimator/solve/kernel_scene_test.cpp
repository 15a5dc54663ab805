// Proves: the kernel's quadrature integrates polynomials exactly as far as Gauss's does; its factor
// and its lights are those of the scene; chunks cover every tile once. Does not prove what the
// kernel makes of them (normal_equations_test).
#include "estimator/solve/kernel_scene.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estimator/model/tangent_basis.h"
#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::solve {
namespace {

// n points are exact up to the degree 2 n - 1; over [-1/2, 1/2] the mean of x^k is 2^-k / (k + 1).
TEST(KernelScene, QuadratureIsGausss) {
  const RandomObservations random(10, 3, 1);
  EvaluateOptions options;
  options.aperture = 0.8;
  const KernelScene scene(random.observations, TwoLights(), options);
  for (int n = 1; n <= kernel::kMaxSamples; ++n)
    for (int degree = 0; degree < 2 * n; ++degree) {
      double mean = 0.0;
      for (int i = 0; i < n; ++i)
        mean += scene.model.weight[n][i] * std::pow(scene.model.node[n][i] / 0.8, degree);
      const double exact = degree % 2 == 0 ? std::pow(0.5, degree) / (degree + 1) : 0.0;
      EXPECT_NEAR(mean, exact, 1e-15) << n << " points, degree " << degree;
    }
}

TEST(KernelScene, HoldsTheSceneAndTheColoursFactor) {
  for (const int channels : {1, 3}) {
    const RandomObservations random(10, channels, 1);
    const model::Scene truth = TwoLights();
    const KernelScene scene(random.observations, truth, {});
    const kernel::KernelModel& m = scene.model;
    ASSERT_EQ(m.lights, 2);
    EXPECT_EQ(m.light, scene.lights.data());
    for (std::size_t l = 0; l < 2; ++l) {
      const auto basis = model::TangentBasis(truth.lights[l].direction);
      for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(m.light[l].direction[k], truth.lights[l].direction[k]);
        EXPECT_EQ(m.light[l].tangent[1][k], basis(k, 1));
      }
      EXPECT_EQ(m.light[l].inverse_distance, truth.lights[l].inverse_distance);
    }
    const Eigen::VectorXd albedo = truth.reflectance.albedo.head(channels);
    EXPECT_NEAR(m.l11 * m.l11, albedo.squaredNorm(), 1e-15);
    EXPECT_NEAR(m.l11 * m.l21, albedo.sum(), 1e-15);
    EXPECT_NEAR(m.l21 * m.l21 + m.l22 * m.l22, channels, 1e-12);
  }
}

TEST(Chunks, CoverEveryTileOnce) {
  for (const std::size_t tiles : {0u, 1u, 3u, 4u, 5u, 63u, 64u, 65u, 1000u, 1024u, 1025u, 99999u}) {
    const Chunks chunks(tiles);
    std::size_t next = 0;
    for (std::size_t chunk = 0; chunk < chunks.count(); ++chunk) {
      EXPECT_EQ(chunks.First(chunk), next);
      EXPECT_GE(chunks.Tiles(chunk), 1u);
      EXPECT_LE(chunks.Tiles(chunk), 64u);
      next += chunks.Tiles(chunk);
    }
    EXPECT_EQ(next, tiles);
  }
}

TEST(PixelsOf, PointIntoTheArraysFromTheTileOn) {
  const RandomObservations random(5 * observe::kTile, 1, 1);
  const observe::Observations& all = random.observations;
  EvaluateOptions options;
  std::vector<const std::uint8_t*> lit;
  kernel::KernelPixels pixels = PixelsOf(all, options, 2, 3, kAll, lit);
  EXPECT_EQ(pixels.position[2], all.position[2].data() + 2 * observe::kTile);
  EXPECT_EQ(pixels.radiance[1], nullptr) << "one channel";
  EXPECT_EQ(pixels.tiles, 3u);
  EXPECT_EQ(pixels.samples, nullptr);
  EXPECT_EQ(pixels.lit, nullptr);
  EXPECT_EQ(pixels.usable, nullptr);
  options.samples_per_side.assign(all.tiles(), 2);
  const auto plane = std::make_shared<std::vector<std::uint8_t>>(all.size(), 1);
  options.shadows.lit = {plane, plane};
  options.shadows.usable = plane;
  pixels = PixelsOf(all, options, 2, 3, kAll, lit);
  EXPECT_EQ(pixels.samples, options.samples_per_side.data() + 2);
  ASSERT_NE(pixels.lit, nullptr);
  EXPECT_EQ(pixels.lit[1], plane->data() + 2 * observe::kTile);
  EXPECT_EQ(pixels.usable, plane->data() + 2 * observe::kTile);
}

}  // namespace
}  // namespace turnlight::estimator::solve
