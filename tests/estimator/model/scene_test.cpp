// Proves the scene model against closed forms: a light moved to another origin is the same light at
// every point; Lambert, Oren-Nayar, Phong and Blinn-Phong have the values that their formulas give
// at chosen angles; Shade is their sum, with falloff, shadow and colour. Does not prove that a real
// surface follows any of them.
#include "estimator/model/scene.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/estimator/directions.h"

namespace turnlight::estimator::model {
namespace {

using Eigen::Vector3d;

// In the plane of x and z, so many degrees from +z towards +x.
Vector3d FromZenith(double degrees) {
  return {std::sin(DegToRad(degrees)), 0.0, std::cos(DegToRad(degrees))};
}

Light RandomLight(const RandomStream& random, std::uint64_t index) {
  Light light;
  light.direction = RandomUnit(random, index);
  light.inverse_distance = index % 4 == 0 ? 0.0 : random.Uniform(5000 + index, 0.0, 0.5);
  light.intensity = random.Uniform(6000 + index, 0.1, 3.0);
  return light;
}

// Where the light is and what it does at a point do not depend on the origin.
TEST(Light, RecentredIsTheSameLightEverywhere) {
  const RandomStream random(3, 3);
  for (std::uint64_t i = 0; i < 100; ++i) {
    const Light light = RandomLight(random, i);
    const Vector3d origin = random.Uniform(7000 + i) * RandomUnit(random, 1000 + i);
    const Light moved = Recentred(light, origin);
    EXPECT_NEAR(moved.direction.norm(), 1.0, 1e-14);
    if (light.inverse_distance > 0.0) {
      const Vector3d position = light.direction / light.inverse_distance;
      EXPECT_LT((moved.direction / moved.inverse_distance + origin - position).norm(),
                1e-12 * position.norm());
    } else {
      EXPECT_EQ(moved.inverse_distance, 0.0);
      EXPECT_LT((moved.direction - light.direction).norm(), 1e-15);
    }
    const Vector3d x = random.Uniform(8000 + i) * RandomUnit(random, 2000 + i);
    const Vector3d before = light.Toward(x), after = moved.Toward(x - origin);
    EXPECT_LT((before.normalized() - after.normalized()).norm(), 1e-14);
    EXPECT_NEAR(moved.intensity / after.squaredNorm(), light.intensity / before.squaredNorm(),
                1e-12 * light.intensity / before.squaredNorm());
    const Light back = Recentred(moved, -origin);
    EXPECT_LT((back.direction - light.direction).norm(), 1e-14);
    EXPECT_NEAR(back.inverse_distance, light.inverse_distance, 1e-14);
    EXPECT_NEAR(back.intensity, light.intensity, 1e-13);
  }
}

TEST(DiffuseTerm, LambertIsTheCosineAboveTheHorizon) {
  const Reflectance lambert;
  EXPECT_NEAR(DiffuseTerm(lambert, Vector3d::UnitZ(), FromZenith(60), FromZenith(-20)), 0.5, 1e-15);
  EXPECT_EQ(DiffuseTerm(lambert, Vector3d::UnitZ(), FromZenith(91), FromZenith(0)), 0.0);
}

// Oren and Nayar's equation in its own words: cos t_i (A + B max(0, cos dphi) sin alpha tan beta).
TEST(DiffuseTerm, DepartsFromItsModelWithTheNormal) {
  Reflectance reflectance;
  reflectance.shading[2] = 0.1;   // sqrt(3) z
  reflectance.shading[3] = -0.2;  // sqrt(15) x y
  const Vector3d normal = Vector3d(1.0, 2.0, 2.0) / 3.0, light(0.0, 0.0, 1.0);
  const double departure =
      1.0 + 0.1 * std::sqrt(3.0) * 2.0 / 3.0 - 0.2 * std::sqrt(15.0) * 2.0 / 9.0;
  EXPECT_NEAR(DiffuseTerm(reflectance, normal, light, normal), 2.0 / 3.0 * departure, 1e-15);
}

TEST(DiffuseTerm, OrenNayarIsThePublishedFormula) {
  Reflectance rough;
  rough.diffuse_model = DiffuseModel::kOrenNayar;
  for (const double roughness_deg : {0.0, 10.0, 30.0}) {
    rough.roughness = DegToRad(roughness_deg);
    const double v = rough.roughness * rough.roughness;
    const double a = 1.0 - 0.5 * v / (v + 0.33), b = 0.45 * v / (v + 0.09);
    for (const double in : {10.0, 45.0, 75.0})
      for (const double out : {20.0, 60.0}) {
        const double cosine = std::cos(DegToRad(in));
        const double lift =
            b * std::sin(DegToRad(std::max(in, out))) * std::tan(DegToRad(std::min(in, out)));
        EXPECT_NEAR(DiffuseTerm(rough, Vector3d::UnitZ(), FromZenith(in), FromZenith(out)),
                    cosine * (a + lift), 1e-14);
        EXPECT_NEAR(DiffuseTerm(rough, Vector3d::UnitZ(), FromZenith(in), FromZenith(-out)),
                    cosine * a, 1e-14);
      }
  }
}

TEST(SpecularTerm, IsOneInTheMirrorAndAPowerOfTheCosineBeside) {
  Reflectance r;
  for (const double shininess : {0.5, 20.0, 3e4}) {
    r.lobes[0].shape = shininess;
    for (const double off : {0.0, 0.5, 12.0}) {
      const double power = std::pow(std::cos(DegToRad(off)), shininess);
      r.lobes[0].model = SpecularModel::kPhong;
      EXPECT_NEAR(
          SpecularTerm(r.lobes[0], Vector3d::UnitZ(), FromZenith(40 + off), FromZenith(-40)), power,
          1e-11);
      // The half vector turns by half as much.
      r.lobes[0].model = SpecularModel::kBlinnPhong;
      EXPECT_NEAR(
          SpecularTerm(r.lobes[0], Vector3d::UnitZ(), FromZenith(40 + 2 * off), FromZenith(-40)),
          power, 1e-11);
      r.lobes[0].model = SpecularModel::kNone;
      EXPECT_EQ(SpecularTerm(r.lobes[0], Vector3d::UnitZ(), FromZenith(40 + off), FromZenith(-40)),
                0.0);
    }
  }
}

TEST(SpecularTerm, EndsAtTheHorizonAndARightAngleFromTheMirror) {
  Reflectance r;
  r.lobes[0].shape = 0.5;
  for (const auto model : {SpecularModel::kPhong, SpecularModel::kBlinnPhong}) {
    r.lobes[0].model = model;
    EXPECT_EQ(SpecularTerm(r.lobes[0], Vector3d::UnitZ(), FromZenith(90.5), FromZenith(-85)), 0.0);
  }
  r.lobes[0].model = SpecularModel::kPhong;
  EXPECT_GT(SpecularTerm(r.lobes[0], Vector3d::UnitZ(), FromZenith(-29), FromZenith(-60)), 0.0);
  EXPECT_EQ(SpecularTerm(r.lobes[0], Vector3d::UnitZ(), FromZenith(-31), FromZenith(-60)), 0.0);
}

TEST(LobeHalfWidth, IsWhereTheLobeIsHalf) {
  for (const double n : {0.5, 1.0, 20.0, 1e5}) {
    const double width = LobeHalfWidth({SpecularModel::kPhong, 1.0, n});
    EXPECT_NEAR(std::pow(std::cos(width), n), 0.5, 1e-9) << n;
  }
  EXPECT_NEAR(RadToDeg(LobeHalfWidth({SpecularModel::kPhong, 1.0, 1.0})), 60.0, 1e-12);
}

TEST(SetLobeModel, ConvertsTheFirstAndNoneDropsBoth) {
  Reflectance r;
  r.lobes = {Lobe{SpecularModel::kGgx, 0.3, 0.2, 0.04}, Lobe{SpecularModel::kPhong, 0.1, 12.0}};
  const double peak = LobePeak(r.lobes[0]), inverse = LobeInverseVariance(r.lobes[0]);
  SetLobeModel(r, SpecularModel::kGgx);
  EXPECT_EQ(r.lobes[0].f0, 0.04);
  SetLobeModel(r, SpecularModel::kPhong);
  EXPECT_EQ(r.lobes[0].model, SpecularModel::kPhong);
  EXPECT_EQ(r.lobes[0].f0, 1.0);
  EXPECT_NEAR(LobePeak(r.lobes[0]), peak, 1e-12);
  // Mirrored rays turn twice as fast as the normal.
  EXPECT_DOUBLE_EQ(4.0 * LobeInverseVariance(r.lobes[0]), inverse);
  EXPECT_EQ(r.lobes[1].shape, 12.0);
  SetLobeModel(r, SpecularModel::kNone);
  for (const Lobe& lobe : r.lobes) EXPECT_FALSE(lobe.present());
  EXPECT_EQ(r.lobes[0].strength, 0.0);
}

// A near light over a point above the origin: half as far, four times as bright.
TEST(Shade, AddsLightsWithTheirFalloffColourAndShadow) {
  Scene scene;
  scene.lights = {{Vector3d::UnitZ(), 0.1, 2.0, {1.0, 0.5, 0.25}},
                  {FromZenith(60), 0.0, 1.0, Vector3d::Ones()}};
  Reflectance& r = scene.reflectance;
  r.albedo = {0.8, 0.4, 0.2};
  r.ambient = 0.1;
  r.diffuse = 0.5;
  r.lobes[0].strength = 0.25;
  r.lobes[0].shape = 10.0;
  const Vector3d up = Vector3d::UnitZ(), point(0, 0, 5);
  const Vector3d first(8.0, 4.0, 2.0);  // irradiance of the near light there
  const double lobe = std::pow(0.5, 10);
  const Vector3d both =
      r.albedo.cwiseProduct(Vector3d::Constant(0.1) + 0.5 * (first + Vector3d::Constant(0.5))) +
      0.25 * (first + Vector3d::Constant(lobe));
  EXPECT_LT((Shade(scene, point, up, up) - both).norm(), 1e-14);
  const Vector3d shadowed =
      r.albedo.cwiseProduct(Vector3d::Constant(0.1) + 0.5 * first) + 0.25 * first;
  EXPECT_LT((Shade(scene, point, up, up, 0b01) - shadowed).norm(), 1e-14);
  EXPECT_LT((Shade(scene, point, up, up, 0) - 0.1 * r.albedo).norm(), 1e-15);
  EXPECT_EQ(Shade(scene, point, up, FromZenith(91)), Vector3d::Zero());
}

}  // namespace
}  // namespace turnlight::estimator::model
