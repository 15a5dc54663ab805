// Proves: what an estimate does not know is listed and noted, a light without a direction leaves
// the list or, if it is the brightest, ends the estimate; and what is known stays. Does not prove
// that sigmas are right: the studies do.
#include "estimator/determined.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/angles.h"
#include "tests/estimator/random_observations.h"
#include "tests/estimator/small_scene.h"

namespace turnlight::estimator {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Two lights, everything known to a hundredth.
Estimate Known() {
  Estimate estimate;
  estimate.views = 3;
  estimate.pixels = 5000;
  for (int i = 0; i < 2; ++i) {
    LightEstimate& light = estimate.lights.emplace_back();
    light.light.intensity = i == 0 ? 1.0 : 0.5;
    light.direction_sigma = 0.01;
    if (i > 0) light.intensity_sigma = 0.01;
    light.diffuse_product = {0.4, 0.3, 0.2};
    light.diffuse_product_sigma = {0.01, 0.01, 0.01};
    light.specular_product[0] = 0.2;
    light.specular_product_sigma[0] = 0.01;
  }
  estimate.stat.lights.resize(2);
  estimate.budget.emplace_back().sigma.lights.resize(2);
  estimate.reflectance = Glossy(0.1, 0.5, 0.2);
  estimate.reflectance.albedo = {1.0, 0.8, 0.6};
  estimate.sigma = {{0.0, 0.01, 0.01}, 0.01, 0.01, {}, std::nullopt};
  estimate.sigma.lobes[0] = {0.01, 1.0, std::nullopt};
  estimate.ambient_product = {0.1, 0.08, 0.06};
  estimate.ambient_product_sigma = {0.01, 0.01, 0.01};
  return estimate;
}

// Of brightness about 1.
observe::Observations Pixels() {
  observe::Observations all = RandomObservations(2000, 3, 1).observations;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (int c = 0; c < 3; ++c)
      all.radiance[c][i] = 0.5f + 0.5f * std::sin(0.01f * static_cast<float>(i));
  return all;
}

std::vector<std::string> UnknownOf(Estimate estimate) {
  const Status status = LeaveOutUnknown(Pixels(), estimate);
  EXPECT_TRUE(status) << status.error().text;
  EXPECT_EQ(estimate.undetermined.empty(), estimate.notes.empty());
  return estimate.undetermined;
}

TEST(Determined, WhatIsKnownStays) {
  EXPECT_THAT(UnknownOf(Known()), IsEmpty());
  Estimate without_sigmas = Known();
  without_sigmas.has_sigmas = false;
  without_sigmas.lights[0].direction_sigma = kNaN;
  EXPECT_THAT(UnknownOf(without_sigmas), IsEmpty());
  // Known to be small is known.
  Estimate matte = Known();
  matte.reflectance.ambient = 0.0;
  EXPECT_THAT(UnknownOf(matte), IsEmpty());
}

TEST(Determined, EachValueWhoseSigmaAllowsAnything) {
  Estimate estimate = Known();
  estimate.reflectance.diffuse = 0.0;
  estimate.sigma.diffuse = 0.083;
  EXPECT_THAT(UnknownOf(estimate), ElementsAre("reflectance/diffuse"));
  estimate = Known();
  estimate.sigma.ambient = kNaN;
  EXPECT_THAT(UnknownOf(estimate), ElementsAre("reflectance/ambient"));
  estimate = Known();
  estimate.lights[1].intensity_sigma = 0.6;
  EXPECT_THAT(UnknownOf(estimate), ElementsAre("lights/1/intensity"));
  estimate = Known();
  estimate.sigma.albedo[2] = 0.7;
  EXPECT_THAT(UnknownOf(estimate), ElementsAre("reflectance/albedo/2"));
  estimate = Known();
  estimate.sigma.lobes[0].shape = std::nullopt;
  EXPECT_THAT(UnknownOf(estimate),
              ElementsAre("reflectance/shininess", "reflectance/lobe/fwhm_deg"));
  estimate = Known();
  estimate.sigma.lobes[0].strength = 5.0;
  EXPECT_THAT(UnknownOf(estimate), ElementsAre("reflectance/specular", "reflectance/lobe/peak"));
  estimate = Known();
  estimate.reflectance.diffuse_model = model::DiffuseModel::kOrenNayar;
  estimate.reflectance.roughness = DegToRad(10.0);
  estimate.sigma.roughness = DegToRad(40.0);
  EXPECT_THAT(UnknownOf(estimate), ElementsAre("reflectance/roughness_deg"));
  estimate = Known();
  estimate.lights[0].diffuse_product_sigma.setConstant(0.9);
  estimate.lights[1].specular_product_sigma[0] = 7.0;
  EXPECT_THAT(UnknownOf(estimate), ElementsAre("products/diffuse/0/0", "products/diffuse/0/1",
                                               "products/diffuse/0/2", "products/specular/1"));
}

TEST(Determined, AlphaAndTheSecondLobeToo) {
  Estimate estimate = Known();
  estimate.reflectance.lobes = {model::Lobe{model::SpecularModel::kGgx, 0.2, 0.1, 1.0},
                                model::Lobe{model::SpecularModel::kPhong, 0.2, 12.0}};
  estimate.sigma.lobes[0] = {0.01, 0.16, std::nullopt};
  estimate.sigma.lobes[1] = {0.01, 40.0, std::nullopt};
  EXPECT_THAT(UnknownOf(estimate), IsEmpty());
  // An alpha is between 0.003 and 1: 1.7 of it say nothing, where 3.5 of a shininess do.
  estimate.sigma.lobes[0].shape = 0.18;
  EXPECT_THAT(
      UnknownOf(estimate),
      ElementsAre("reflectance/lobe/peak", "reflectance/lobe/fwhm_deg", "reflectance/lobes/0/alpha",
                  "reflectance/lobes/0/peak", "reflectance/lobes/0/fwhm_deg"));
  estimate.sigma.lobes[0].shape = 0.1;
  estimate.sigma.lobes[1].shape = 45.0;
  EXPECT_THAT(UnknownOf(estimate),
              ElementsAre("reflectance/lobes/1/shininess", "reflectance/lobes/1/fwhm_deg"));
  estimate.sigma.lobes[1] = {5.0, 1.0, std::nullopt};
  EXPECT_THAT(UnknownOf(estimate),
              ElementsAre("reflectance/lobes/1/specular", "reflectance/lobes/1/peak"));
}

TEST(Determined, TheNoteNamesThemForAPerson) {
  Estimate estimate = Known();
  estimate.ambient_product_sigma.setConstant(kNaN);
  estimate.sigma.ambient = kNaN;
  ASSERT_TRUE(LeaveOutUnknown(Pixels(), estimate));
  ASSERT_EQ(estimate.notes.size(), 1u);
  EXPECT_EQ(estimate.notes[0].code, "not-determined");
  EXPECT_THAT(estimate.notes[0].text,
              HasSubstr("reflectance/ambient, products/ambient: their sigmas"));
}

TEST(Determined, WithoutALightNothingShowsTheDiffusePart) {
  Estimate estimate = Known();
  estimate.lights.clear();
  estimate.stat.lights.clear();
  estimate.sigma.diffuse = kNaN;
  ASSERT_TRUE(LeaveOutUnknown(Pixels(), estimate));
  EXPECT_THAT(estimate.notes[0].text, HasSubstr("there is no light to see them by"));
}

TEST(Determined, ALightWithoutADirectionLeavesTheList) {
  for (const double sigma : {DegToRad(46.0), kNaN}) {
    Estimate estimate = Known();
    estimate.lights[1].direction_sigma = sigma;
    estimate.correlation.quantities = {{"intensity", "", 1, 0.1}, {"ambient", "", {}, 0.1}};
    estimate.correlation.matrix = Eigen::Matrix2d::Identity();
    ASSERT_TRUE(LeaveOutUnknown(Pixels(), estimate));
    EXPECT_EQ(estimate.lights.size(), 1u);
    EXPECT_EQ(estimate.stat.lights.size(), 1u);
    EXPECT_EQ(estimate.budget[0].sigma.lights.size(), 1u);
    ASSERT_EQ(estimate.correlation.quantities.size(), 1u);
    EXPECT_EQ(estimate.correlation.quantities[0].name(), "ambient");
    EXPECT_THAT(estimate.notes[0].text, HasSubstr("1 light is left out of the list"));
    estimate = Known();
    estimate.lights[0].direction_sigma = sigma;
    const Status refused = LeaveOutUnknown(Pixels(), estimate);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::kNoEstimate);
    EXPECT_THAT(refused.error().text,
                AllOf(HasSubstr("direction of the brightest light is not known to 45 degrees"),
                      HasSubstr("from 3 views with 5000 usable pixels")));
  }
  Estimate estimate = Known();
  estimate.lights[1].direction_sigma = DegToRad(44.0);
  EXPECT_THAT(UnknownOf(estimate), IsEmpty());
}

TEST(Determined, NoiseIsNamedWhereItHidesTheDirection) {
  Estimate estimate = Known();
  estimate.lights[0].direction_sigma = kNaN;
  observe::Observations all = Pixels();
  const RandomStream random(3, 3);
  for (std::size_t i = 0; i < all.size(); ++i)
    for (int c = 0; c < 3; ++c)
      all.radiance[c][i] = static_cast<float>(0.3 + 0.2 * random.Normal(3 * i + c));
  for (std::size_t i = 0; i < all.size(); ++i) all.pixel[i] = static_cast<std::uint32_t>(i);
  const Status refused = LeaveOutUnknown(all, estimate);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().text, AllOf(HasSubstr("the noise is "), HasSubstr("lower the gain")));
}

}  // namespace
}  // namespace turnlight::estimator
