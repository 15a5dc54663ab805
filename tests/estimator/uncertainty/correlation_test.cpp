// Proves: of a covariance written by hand the correlations and sigmas in closed form, which rows
// there are and what they are called, and a direction's two coordinates; that the covariance of an
// estimate has the squares of sigma_total on its diagonal; and that its correlations are those of
// the errors over 200 draws of the noise. Does not prove correlations of what the model has wrong.
#include "estimator/uncertainty/correlation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/angles.h"
#include "estimator/model/tangent_basis.h"
#include "estimator/uncertainty/quantities.h"
#include "estimator/uncertainty/uncertainty.h"
#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::uncertainty {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::Not;

std::vector<std::string> NamesOf(const Correlation& correlation) {
  std::vector<std::string> names;
  for (const CorrelatedQuantity& quantity : correlation.quantities)
    names.push_back(quantity.name());
  return names;
}

Eigen::Index RowOf(const Correlation& correlation, const std::string& name) {
  const auto names = NamesOf(correlation);
  const auto found = std::find(names.begin(), names.end(), name);
  EXPECT_NE(found, names.end()) << name;
  return found - names.begin();
}

double Of(const Correlation& correlation, const std::string& a, const std::string& b) {
  return correlation.matrix(RowOf(correlation, a), RowOf(correlation, b));
}

// What is reported of two lights, and a covariance of it: nothing but what a test puts in.
struct ByHand {
  Reported at;
  Eigen::MatrixXd covariance;

  explicit ByHand(const model::Scene& scene = TwoLights())
      : at(Report(scene, {}, {0, 1})),
        covariance(Eigen::MatrixXd::Zero(CountOfQuantities(2), CountOfQuantities(2))) {}
  void Put(Eigen::Index a, Eigen::Index b, double value) {
    covariance(a, b) = covariance(b, a) = value;
  }
  Correlation Made(int channels = 3) const { return CorrelationOf(covariance, at, channels); }
};

TEST(CorrelationOf, IsTheCovarianceOverTheSigmas) {
  ByHand by_hand;
  const Eigen::Index intensity = At(OfLight::kIntensity, 1), ambient = At(OfTarget::kAmbient, 2),
                     shape = At(OfTarget::kLobes, 2) + 1;
  by_hand.Put(intensity, intensity, 0.04);
  by_hand.Put(ambient, ambient, 0.25);
  by_hand.Put(shape, shape, 9.0);
  by_hand.Put(intensity, ambient, -0.06);  // 0.2 x 0.5 x -0.6
  by_hand.Put(ambient, shape, 0.3);        // 0.5 x 3 x 0.2
  const Correlation correlation = by_hand.Made();
  ASSERT_THAT(NamesOf(correlation), ElementsAre("intensity of light 2", "ambient", "shininess"));
  EXPECT_DOUBLE_EQ(correlation.quantities[0].sigma, 0.2);
  EXPECT_DOUBLE_EQ(correlation.quantities[2].sigma, 3.0);
  EXPECT_EQ(correlation.matrix.diagonal(), Eigen::Vector3d::Ones());
  EXPECT_NEAR(correlation.matrix(0, 1), -0.6, 1e-15);
  EXPECT_NEAR(correlation.matrix(2, 1), 0.2, 1e-15);
  EXPECT_EQ(correlation.matrix(0, 2), 0.0);
  EXPECT_EQ(correlation.matrix, correlation.matrix.transpose());
}

TEST(CorrelationOf, RoundingLeavesNoMoreThanOne) {
  ByHand by_hand;
  const Eigen::Index a = At(OfTarget::kAmbient, 2), b = At(OfTarget::kDiffuse, 2);
  by_hand.Put(a, a, 1e-4);
  by_hand.Put(b, b, 1e-4);
  by_hand.Put(a, b, -1e-4 * (1.0 + 1e-9));
  EXPECT_EQ(by_hand.Made().matrix(0, 1), -1.0);
}

// An error of a direction along a vector across it is seen in azimuth and zenith angle as far as
// it goes along each, and signs follow.
TEST(CorrelationOf, ADirectionsCoordinatesAreAzimuthAndZenith) {
  model::Scene scene = TwoLights();
  const double azimuth = DegToRad(110.0), zenith = DegToRad(50.0);
  scene.lights[0].direction = {std::sin(zenith) * std::cos(azimuth),
                               std::sin(zenith) * std::sin(azimuth), std::cos(zenith)};
  ByHand by_hand(scene);
  const Eigen::Vector3d& u = by_hand.at.lights[0].light.direction;
  const double step = 1e-5;
  const auto at = [](double a, double z) {
    return Eigen::Vector3d(std::sin(z) * std::cos(a), std::sin(z) * std::sin(a), std::cos(z));
  };
  const Eigen::Vector3d error =
      at(azimuth + 4.0 * step / std::sin(zenith), zenith - 3.0 * step) - u;
  const Eigen::Vector2d tangent = model::TangentBasis(u).transpose() * error;
  by_hand.covariance.block<2, 2>(At(OfLight::kDirection, 0), At(OfLight::kDirection, 0)) =
      tangent * tangent.transpose();
  const Correlation correlation = by_hand.Made();
  ASSERT_THAT(NamesOf(correlation),
              ElementsAre("direction of light 1, azimuth", "direction of light 1, zenith"));
  EXPECT_NEAR(correlation.quantities[0].sigma, RadToDeg(4.0 * step), 0.01 * RadToDeg(step));
  EXPECT_NEAR(correlation.quantities[1].sigma, RadToDeg(3.0 * step), 0.01 * RadToDeg(step));
  EXPECT_NEAR(correlation.matrix(0, 1), -1.0, 1e-12);
}

TEST(CorrelationOf, AtThePolesTheAzimuthIsZero) {
  for (const double z : {1.0, -1.0}) {
    model::Scene scene = TwoLights();
    scene.lights[0].direction = {0.0, 0.0, z};
    ByHand by_hand(scene);
    const Eigen::Vector2d tangent =
        model::TangentBasis(scene.lights[0].direction).transpose() * Eigen::Vector3d(2e-3, 1e-3, 0);
    by_hand.covariance.block<2, 2>(At(OfLight::kDirection, 0), At(OfLight::kDirection, 0)) =
        tangent * tangent.transpose();
    const Correlation correlation = by_hand.Made();
    EXPECT_NEAR(correlation.quantities[0].sigma, RadToDeg(1e-3), 1e-12);
    EXPECT_NEAR(correlation.quantities[1].sigma, RadToDeg(2e-3), 1e-12);
    EXPECT_NEAR(correlation.matrix(0, 1), z, 1e-12);
  }
}

TEST(CorrelationOf, WhatIsNotDeterminedHasNoRow) {
  ByHand by_hand;
  by_hand.covariance.setIdentity();
  const Eigen::Index diffuse = At(OfTarget::kDiffuse, 2), direction = At(OfLight::kDirection, 1);
  for (const Eigen::Index q : {diffuse, direction}) {
    by_hand.covariance.row(q).setConstant(std::numeric_limits<double>::quiet_NaN());
    by_hand.covariance.col(q).setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  const Correlation correlation = by_hand.Made();
  EXPECT_THAT(NamesOf(correlation), Not(Contains("diffuse")));
  EXPECT_THAT(NamesOf(correlation), Not(Contains("direction of light 2, zenith")));
  EXPECT_THAT(NamesOf(correlation), Contains("direction of light 1, zenith"));
  EXPECT_TRUE(correlation.matrix.allFinite());
}

TEST(CorrelationOf, RowsAreWhatTheModelHas) {
  model::Scene scene = TwoLights(0.0, 0.25);
  scene.lights[1].color = {1.0, 0.8, 0.6};
  model::Reflectance& r = scene.reflectance;
  r.harmonics[2] = 0.1;
  r.diffuse_model = model::DiffuseModel::kOrenNayar;
  r.lobes = {model::Lobe{model::SpecularModel::kGgx, 0.3, 0.1, 0.5},
             model::Lobe{model::SpecularModel::kPhong, 0.1, 5.0}};
  ByHand rich(scene);
  rich.covariance.setIdentity();
  const auto names = NamesOf(rich.Made());
  for (const char* name :
       {"inverse distance of light 1", "distance of light 2", "colour of light 2, green",
        "diffuse product of light 1, blue", "specular product of light 2", "roughness", "alpha",
        "f0", "specular of lobe 2", "shininess of lobe 2", "ambient harmonic 8",
        "ambient product, red"})
    EXPECT_THAT(names, Contains(name));
  for (const char* name :
       {"distance of light 1", "inverse distance of light 2", "intensity of light 1",
        "colour of light 1, green", "f0 of lobe 2", "shininess", "ambient colour, red"})
    EXPECT_THAT(names, Not(Contains(name)));
  ByHand plain;
  plain.covariance.setIdentity();
  for (const char* name : {"roughness", "f0", "ambient harmonic 1", "specular of lobe 2"})
    EXPECT_THAT(NamesOf(plain.Made()), Not(Contains(name)));
  EXPECT_THAT(NamesOf(plain.Made(1)), Contains("albedo"));
  EXPECT_THAT(NamesOf(plain.Made(1)), Not(Contains("albedo, red")));
}

TEST(WithoutLight, LeavesTheOthersAsTheyWere) {
  ByHand by_hand;
  const Eigen::Index count = by_hand.covariance.rows();
  Eigen::MatrixXd root = Eigen::MatrixXd::Identity(count, count);
  for (Eigen::Index q = 0; q < root.size(); ++q)
    root(q % count, q / count) += 0.1 * std::sin(static_cast<double>(q));
  by_hand.covariance = root * root.transpose();
  const Correlation both = by_hand.Made(), second = WithoutLight(both, 0);
  EXPECT_THAT(NamesOf(second), Contains("distance of light 1"));
  EXPECT_THAT(NamesOf(second), Not(Contains("distance of light 2")));
  EXPECT_EQ(Of(second, "distance of light 1", "ambient"),
            Of(both, "distance of light 2", "ambient"));
  EXPECT_EQ(second.matrix.rows(), static_cast<Eigen::Index>(second.quantities.size()));
  EXPECT_EQ(Of(WithoutLight(both, 1), "distance of light 1", "ambient"),
            Of(both, "distance of light 1", "ambient"));
}

// 200 draws of a noise that the model is right about.
struct Draws {
  static constexpr int kCount = 200;
  Reported truth;
  std::vector<Eigen::VectorXd> found;  // reported vectors
  std::vector<Correlation> predicted;  // of sigma_total

  Draws() {
    const model::Scene scene = TwoLights();
    const RandomObservations clean(1500, 3, 1, &scene);
    truth = Report(scene, clean.observations, {0, 1});
    for (int draw = 0; draw < kCount; ++draw) {
      observe::Observations pixels = clean.observations;
      AddNoise(0.003, static_cast<std::uint64_t>(draw), pixels);
      const solve::Solution solution = solve::Solve(pixels, scene, {});
      found.push_back(Flatten(Report(solution.scene, pixels, {0, 1}), truth));
      const Uncertainties sigmas =
          EstimateUncertainty(solution, pixels, {0, 1}, 1.0, SplitResiduals(pixels, solution));
      predicted.push_back(CorrelationOf(sigmas.covariance, truth, 3));
    }
  }
  // The median of what is predicted. In a few draws halves disagree about a quantity by more than 3
  // sigmas, by chance, which counts as an error that need not go with others.
  double Predicted(Eigen::Index i, Eigen::Index j) const {
    std::vector<double> all;
    for (const Correlation& one : predicted) all.push_back(one.matrix(i, j));
    std::nth_element(all.begin(), all.begin() + kCount / 2, all.end());
    return all[kCount / 2];
  }
  Eigen::MatrixXd Sampled() const {
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(found[0].size());
    for (const Eigen::VectorXd& one : found) mean += one;
    mean /= kCount;  // of what is always 1 exactly that
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(mean.size(), mean.size());
    for (const Eigen::VectorXd& one : found) sum += (one - mean) * (one - mean).transpose();
    return sum / (kCount - 1);
  }
};

// By Fisher's transformation atanh r of a sample scatters by 1 / sqrt(n - 3) about that of the
// truth, whatever that is. 4.5 sigmas: chance exceeds them for one of 300 pairs in 0.2 %.
TEST(CorrelationOf, AgreesWithDrawsOfTheNoise) {
  const Draws draws;
  const Correlation sampled = CorrelationOf(draws.Sampled(), draws.truth, 3);
  const std::vector<std::string> names = NamesOf(sampled);
  for (const Correlation& one : draws.predicted) ASSERT_EQ(NamesOf(one), names);
  const auto fisher = [](double r) { return std::atanh(std::clamp(r, -0.999, 0.999)); };
  const double allowed = 4.5 / std::sqrt(Draws::kCount - 3.0);
  int strong = 0;
  for (Eigen::Index i = 0; i < sampled.matrix.rows(); ++i)
    for (Eigen::Index j = 0; j < i; ++j) {
      const double expected = draws.Predicted(i, j);
      EXPECT_NEAR(fisher(sampled.matrix(i, j)), fisher(expected), allowed)
          << names[static_cast<std::size_t>(i)] << ", " << names[static_cast<std::size_t>(j)]
          << ": " << expected;
      strong += std::abs(expected) > 0.5 ? 1 : 0;
    }
  EXPECT_GT(strong, 20) << "there is something to agree on";
}

TEST(EstimateUncertainty, TheCovarianceIsThatOfSigmaTotal) {
  const model::Scene scene = TwoLights();
  observe::Observations pixels = RandomObservations(3000, 3, 1, &scene).observations;
  AddNoise(0.01, 1, pixels);
  // One half is brighter: the model's part is in the total.
  for (std::size_t i = 0; i < pixels.used / 2; ++i) pixels.radiance[1][i] *= 1.05f;
  const solve::Solution solution = solve::Solve(pixels, scene, {});
  const Uncertainties sigmas =
      EstimateUncertainty(solution, pixels, {0, 1}, 1.0, SplitResiduals(pixels, solution));
  EXPECT_GT(sigmas.total.ambient, 1.02 * sigmas.stat.ambient);
  const auto variance = [&](Eigen::Index q) { return sigmas.covariance(q, q); };
  const auto square = [](double sigma) { return sigma * sigma; };
  for (std::size_t l = 0; l < 2; ++l) {
    const LightSigma& light = sigmas.total.lights[l];
    EXPECT_DOUBLE_EQ(variance(At(OfLight::kDistance, l)), square(light.distance));
    EXPECT_DOUBLE_EQ(variance(At(OfLight::kDiffuseProduct, l) + 1),
                     square(light.diffuse_product.y()));
    EXPECT_DOUBLE_EQ(variance(At(OfLight::kSpecularProduct, l)), square(light.specular_product[0]));
  }
  EXPECT_DOUBLE_EQ(variance(At(OfTarget::kAmbient, 2)), square(sigmas.total.ambient));
  EXPECT_DOUBLE_EQ(variance(At(OfTarget::kLobes, 2) + 1), square(sigmas.total.lobes[0].shape));
  EXPECT_DOUBLE_EQ(variance(At(OfTarget::kAlbedo, 2)), square(sigmas.total.albedo.x()));
}

}  // namespace
}  // namespace turnlight::estimator::uncertainty
