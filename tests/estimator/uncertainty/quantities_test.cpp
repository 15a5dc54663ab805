// Proves: every reported quantity has a place of its own in the vector, each is found where the
// table says, and sigmas come back to the members that they are of. Does not prove that sigmas are
// right: uncertainty_test, bench/studies.
#include "estimator/uncertainty/quantities.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::uncertainty {
namespace {

TEST(Quantities, AreWhereTheTableSays) {
  const model::Scene scene = TwoLights();
  const Reported reported = Report(scene, {}, {0, 1});
  const Eigen::VectorXd flat = Flatten(reported, reported);
  ASSERT_EQ(flat.size(), CountOfQuantities(2));
  for (std::size_t l = 0; l < 2; ++l) {
    const ReportedLight& light = reported.lights[l];
    EXPECT_EQ(flat[At(OfLight::kIntensity, l)], light.light.intensity);
    EXPECT_EQ(flat[At(OfLight::kInverseDistance, l)], light.light.inverse_distance);
    EXPECT_EQ(flat[At(OfLight::kDistance, l)], 1.0 / light.light.inverse_distance);
    EXPECT_EQ(flat.segment<3>(At(OfLight::kDiffuseProduct, l)), light.diffuse_product);
    EXPECT_EQ(flat.segment<3>(At(OfLight::kColour, l)), light.light.color);
    EXPECT_LT(flat.segment<2>(At(OfLight::kDirection, l)).norm(), 1e-15);
  }
  EXPECT_EQ(flat[At(OfTarget::kDiffuse, 2)], reported.reflectance.diffuse);
  EXPECT_EQ(flat[At(OfTarget::kLobes, 2) + 1], reported.reflectance.lobes[0].shape);
  EXPECT_EQ(At(OfTarget::kSpecularColour, 2) + SizeOf(OfTarget::kSpecularColour), flat.size());
}

TEST(Quantities, SigmasComeBackToWhatTheyAreOf) {
  const Eigen::Index count = CountOfQuantities(2);
  const Eigen::VectorXd sigmas = Eigen::VectorXd::LinSpaced(count, 1.0, static_cast<double>(count));
  const Eigen::MatrixXd covariance = sigmas.cwiseAbs2().asDiagonal();
  std::vector<bool> unknown(static_cast<std::size_t>(count), false);
  unknown[static_cast<std::size_t>(At(OfTarget::kRoughness, 2))] = true;
  Uncertainty out;
  TakeSigmas(covariance, unknown, 2, out);
  ASSERT_EQ(out.lights.size(), 2u);
  for (std::size_t l = 0; l < 2; ++l) {
    EXPECT_DOUBLE_EQ(out.lights[l].intensity, sigmas[At(OfLight::kIntensity, l)]);
    EXPECT_DOUBLE_EQ(out.lights[l].specular_product[1],
                     sigmas[At(OfLight::kSpecularProduct, l) + 1]);
    EXPECT_DOUBLE_EQ(out.lights[l].colour.z(), sigmas[At(OfLight::kColour, l) + 2]);
  }
  EXPECT_DOUBLE_EQ(out.lobes[1].f0, sigmas[At(OfTarget::kLobes, 2) + 5]);
  EXPECT_DOUBLE_EQ(out.ambient_product.y(), sigmas[At(OfTarget::kAmbientProduct, 2) + 1]);
  EXPECT_DOUBLE_EQ(out.harmonics[7], sigmas[At(OfTarget::kHarmonics, 2) + 7]);
  EXPECT_TRUE(std::isnan(out.roughness));
}

}  // namespace
}  // namespace turnlight::estimator::uncertainty
