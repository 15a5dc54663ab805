// Proves: what is reported does not depend on the gauge that a scene comes in; lights are ordered
// by their strength at W's origin, not at the target; products are those that the pictures show.
// Does not prove anything about errors.
#include "estimator/uncertainty/reported.h"

#include <gtest/gtest.h>

#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::uncertainty {
namespace {

observe::Observations AwayFromTheOrigin() {
  observe::Observations frame;
  frame.reference = {0.4, -0.2, 0.3};
  frame.radius = 2.0;
  return frame;
}

// The same pictures: albedo times a, intensities times b.
model::Scene InAnotherGauge(model::Scene scene, double a, double b) {
  model::Reflectance& r = scene.reflectance;
  r.albedo *= a;
  r.ambient /= a;
  r.diffuse /= a * b;
  r.lobes[0].strength /= b;
  for (model::Light& light : scene.lights) light.intensity *= b;
  return scene;
}

TEST(Report, IsTheSameInEveryGauge) {
  const observe::Observations frame = AwayFromTheOrigin();
  const model::Scene scene = TwoLights();
  const auto order = StrengthOrder(scene, frame);
  const Reported one = Report(scene, frame, order);
  for (const auto& [a, b] : {std::pair{3.0, 0.5}, std::pair{0.1, 1.0}, std::pair{1.0, 20.0}}) {
    const model::Scene other_scene = InAnotherGauge(scene, a, b);
    EXPECT_EQ(StrengthOrder(other_scene, frame), order);
    const Reported other = Report(other_scene, frame, order);
    EXPECT_LT((other.reflectance.albedo - one.reflectance.albedo).norm(), 1e-14);
    EXPECT_NEAR(other.reflectance.ambient, one.reflectance.ambient, 1e-14);
    EXPECT_NEAR(other.reflectance.diffuse, one.reflectance.diffuse, 1e-14);
    EXPECT_NEAR(other.reflectance.lobes[0].strength, one.reflectance.lobes[0].strength, 1e-14);
    EXPECT_LT((other.ambient_product - one.ambient_product).norm(), 1e-14);
    for (std::size_t l = 0; l < 2; ++l) {
      EXPECT_NEAR(other.lights[l].light.intensity, one.lights[l].light.intensity, 1e-14);
      EXPECT_LT((other.lights[l].diffuse_product - one.lights[l].diffuse_product).norm(), 1e-14);
      EXPECT_NEAR(other.lights[l].specular_product[0], one.lights[l].specular_product[0], 1e-14);
    }
  }
  EXPECT_EQ(one.reflectance.albedo.maxCoeff(), 1.0);
  EXPECT_EQ(one.lights[0].light.intensity, 1.0);
}

TEST(Report, ProductsAreThoseOfTheScene) {
  observe::Observations frame;  // about W's origin, in its units
  const model::Scene scene = TwoLights();
  const model::Reflectance& r = scene.reflectance;
  const Reported reported = Report(scene, frame, {0, 1});
  for (std::size_t l = 0; l < 2; ++l) {
    EXPECT_LT(
        (reported.lights[l].diffuse_product - r.albedo * r.diffuse * scene.lights[l].intensity)
            .norm(),
        1e-14);
    EXPECT_NEAR(reported.lights[l].specular_product[0],
                r.lobes[0].strength * scene.lights[l].intensity, 1e-14);
    EXPECT_EQ(reported.lights[l].direction_at_reference, scene.lights[l].direction);
    EXPECT_EQ(reported.lights[l].inverse_distance_at_reference, scene.lights[l].inverse_distance);
  }
  EXPECT_LT((reported.ambient_product - r.albedo * r.ambient).norm(), 1e-15);
}

// Of colours only products with what they multiply can be seen.
TEST(WithLargestColoursOne, ChangesNoPicture) {
  model::Scene scene = TwoLights();
  scene.lights[0].color = {1e14, 9e13, 7e13};
  scene.lights[0].intensity *= 1e-14;
  scene.reflectance.specular_colour = {2e-9, 1e-9, 3e-9};
  scene.reflectance.lobes[0].strength *= 1e9;
  scene.reflectance.harmonics.setConstant(0.01);
  scene.reflectance.ambient_colour = {3.0, 2.0, 0.5};
  const model::Scene one = model::WithLargestColoursOne(scene);
  EXPECT_EQ(one.lights[0].color.maxCoeff(), 1.0);
  EXPECT_EQ(one.reflectance.specular_colour.maxCoeff(), 1.0);
  const Eigen::Vector3d x(0.1, 0.2, 0.7), n = Eigen::Vector3d(0.2, 0.1, 1.0).normalized(),
                                          v = Eigen::Vector3d(-0.1, 0.3, 1.0).normalized();
  const Eigen::Vector3d before = model::Shade(scene, x, n, v), after = model::Shade(one, x, n, v);
  EXPECT_LT((before - after).norm(), 1e-12 * before.norm());
}

// Another light called white is another gauge: products stay.
TEST(Report, TheNamedLightIsWhite) {
  observe::Observations frame;
  model::Scene scene = TwoLights();
  scene.free_colours = true;
  scene.lights[0].color = {1.0, 0.9, 0.7};
  scene.lights[1].color = {0.6, 0.8, 1.0};
  scene.reflectance.ambient_colour = {1.0, 0.7, 0.9};
  scene.reflectance.harmonics.setConstant(0.01);
  const Reported one = Report(scene, frame, {0, 1});
  scene.white_light = 1;
  const Reported other = Report(scene, frame, {0, 1});
  const Eigen::Vector3d white = Eigen::Vector3d::Ones();
  EXPECT_EQ(one.lights[0].light.color, white);
  EXPECT_EQ(other.lights[1].light.color, white);
  EXPECT_NE(other.lights[0].light.color, white);
  EXPECT_LT((one.ambient_product - other.ambient_product).norm(), 1e-14);
  const auto of = [](const Reported& reported) {
    return Eigen::Vector3d(
        reported.reflectance.harmonics[0] *
        reported.reflectance.albedo.cwiseProduct(reported.reflectance.ambient_colour));
  };
  EXPECT_LT((of(one) - of(other)).norm(), 1e-14);
  for (std::size_t l = 0; l < 2; ++l)
    EXPECT_LT((one.lights[l].diffuse_product - other.lights[l].diffuse_product).norm(), 1e-14);
}

// A lamp close to the target is strong there, and weak where W's origin is, far behind.
TEST(StrengthOrder, IsAtTheWorldsOrigin) {
  observe::Observations frame;
  frame.reference = {0.0, 0.0, 10.0};
  model::Scene scene;
  scene.lights = {{Eigen::Vector3d::UnitZ(), 0.5, 1.0, Eigen::Vector3d::Ones()},
                  {Eigen::Vector3d::UnitX(), 0.0, 0.5, Eigen::Vector3d::Ones()}};
  EXPECT_EQ(StrengthOrder(scene, frame), (std::vector<std::size_t>{1, 0}));
  frame.reference.setZero();
  EXPECT_EQ(StrengthOrder(scene, frame), (std::vector<std::size_t>{0, 1}));
}

TEST(Report, OfNoLightIsTheAmbientAlone) {
  model::Scene scene;
  scene.reflectance.albedo = {0.5, 0.25, 0.1};
  scene.reflectance.ambient = 0.4;
  const observe::Observations frame = AwayFromTheOrigin();
  EXPECT_TRUE(StrengthOrder(scene, frame).empty());
  const Reported reported = Report(scene, frame, {});
  EXPECT_LT((reported.ambient_product - 0.4 * scene.reflectance.albedo).norm(), 1e-15);
}

}  // namespace
}  // namespace turnlight::estimator::uncertainty
