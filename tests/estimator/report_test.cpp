// Proves: what is reported of a fit is that fit, in W, in the results' gauge, strongest light
// first, with positions and bounds that follow from inverse distances in closed form, and the rms
// of its own residuals. Does not prove the sigmas (uncertainty_test, recovery_test).
#include "estimator/report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/angles.h"
#include "estimator/solve/normal_equations.h"
#include "tests/estimator/random_observations.h"

namespace turnlight::estimator {
namespace {

// A distant light, and a near one that is the stronger. About a reference away from W's origin, in
// units of 2.
struct ReportCase {
  model::Scene truth = TwoLights(0.0, 0.25);
  observe::Observations all;
  select::Refined refined;
  Estimate estimate;

  explicit ReportCase(const model::ModelChoice& choice = {}) {
    truth.lights[1].intensity = 1.4;
    all = RandomObservations(6000, 3, 1, &truth).observations;
    AddNoise(0.003, 1, all);
    all.reference = {0.4, -0.2, 0.3};
    all.radius = 2.0;
    std::vector<model::Rung> ladder;
    refined = select::Refine(all, truth, 0.003, 1.0, choice, ladder);
    FillFromFit(all, refined, estimate);
  }
};

TEST(FillFromFit, IsTheFitInTheResultsGauge) {
  const ReportCase it;
  const Estimate& e = it.estimate;
  ASSERT_EQ(e.lights.size(), 2u);
  EXPECT_EQ(e.lights[0].light.intensity, 1.0);
  EXPECT_FALSE(e.lights[0].intensity_sigma.has_value());
  EXPECT_GE(e.lights[0].light.intensity, e.lights[1].light.intensity);
  EXPECT_GT(*e.lights[1].intensity_sigma, 0.0);
  EXPECT_EQ(e.reflectance.albedo.maxCoeff(), 1.0);
  EXPECT_EQ(e.reference_point, it.all.reference);
  // Whatever the gauge: the scene that is reported shows the pictures that were fitted.
  const model::Scene& fitted = it.refined.solution.scene;
  const model::Scene reported = e.ToScene();
  const RandomObservations random(50, 3, 9);
  for (const RandomPoint& p : random.points) {
    const Eigen::Vector3d in_fit = model::Shade(fitted, p.position, p.normal, p.viewer);
    const Eigen::Vector3d in_world =
        model::Shade(reported, it.all.reference + 2.0 * p.position, p.normal, p.viewer);
    EXPECT_LT((in_fit - in_world).norm(), 1e-12);
  }
  for (const LightEstimate& light : e.lights) {
    EXPECT_LT((light.diffuse_product -
               e.reflectance.albedo * e.reflectance.diffuse * light.light.intensity)
                  .norm(),
              1e-15);
    EXPECT_NEAR(light.specular_product[0], e.reflectance.lobes[0].strength * light.light.intensity,
                1e-15);
  }
}

TEST(FillFromFit, DistancesFollowFromInverseDistances) {
  const ReportCase it;
  const LightEstimate& near = it.estimate.lights[0];
  ASSERT_TRUE(near.near);
  const double rho = near.light.inverse_distance;
  EXPECT_DOUBLE_EQ(*near.distance, 1.0 / rho);
  EXPECT_LT((*near.position - near.light.direction / rho).norm(), 1e-12);
  EXPECT_NEAR(*near.distance_sigma, near.inverse_distance_sigma / (rho * rho),
              0.01 * *near.distance_sigma);
  EXPECT_LT(*near.distance_min, *near.distance);
  EXPECT_GT(near.position_covariance->trace(), 0.0);
  const LightEstimate& distant = it.estimate.lights[1];
  ASSERT_FALSE(distant.near);
  EXPECT_FALSE(distant.distance || distant.position || distant.distance_sigma);
  const double free = it.refined.inverse_distance[0];
  const double sigma = it.refined.inverse_distance_sigma[0];
  EXPECT_DOUBLE_EQ(*distant.distance_min, 1.0 / (free + 1.6449 * sigma));
  EXPECT_DOUBLE_EQ(distant.inverse_distance_sigma, std::hypot(sigma, free));
}

TEST(FillFromFit, RmsAndHistoryAreOfTheResiduals) {
  const ReportCase it;
  const Estimate& e = it.estimate;
  EXPECT_EQ(e.pixels, it.all.used - it.refined.options.evaluate.shadows.left_out);
  EXPECT_NEAR(e.rms, 0.003, 1e-4);
  ASSERT_EQ(e.history.size(), it.refined.cost_history.size());
  EXPECT_NEAR(e.history.back().rms, e.rms, 1e-6 * e.rms);
  EXPECT_EQ(e.history.back().iteration, e.iterations);
  EXPECT_EQ(e.stopped, solve::Stopped::kTolerance);
}

TEST(FillFromFit, TotalSigmasAreNoSmallerThanTheStatistical) {
  const ReportCase it;
  const Estimate& e = it.estimate;
  ASSERT_EQ(e.stat.lights.size(), 2u);
  for (std::size_t l = 0; l < 2; ++l) {
    EXPECT_GT(e.stat.lights[l].direction, 0.0);
    EXPECT_GE(e.lights[l].direction_sigma, e.stat.lights[l].direction);
    EXPECT_GE(e.lights[l].inverse_distance_sigma, e.stat.lights[l].inverse_distance);
    EXPECT_GE(e.lights[l].specular_product_sigma[0], e.stat.lights[l].specular_product[0]);
  }
  EXPECT_GE(e.sigma.ambient, e.stat.ambient);
  EXPECT_GE(*e.sigma.lobes[0].shape, e.stat.lobes[0].shape);
}

// Every sigma that is reported, in its row.
TEST(FillFromFit, CorrelationsAreOfTheReportedSigmas) {
  const ReportCase it;
  const Estimate& e = it.estimate;
  const auto row = [&](const std::string& name) {
    const auto& all = e.correlation.quantities;
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const auto& q) { return q.name() == name; });
    EXPECT_NE(found, all.end()) << name;
    return found - all.begin();
  };
  const auto sigma = [&](const std::string& name) {
    return e.correlation.quantities[static_cast<std::size_t>(row(name))].sigma;
  };
  EXPECT_DOUBLE_EQ(sigma("distance of light 1"), *e.lights[0].distance_sigma);
  EXPECT_DOUBLE_EQ(sigma("inverse distance of light 2"), e.lights[1].inverse_distance_sigma);
  EXPECT_DOUBLE_EQ(sigma("intensity of light 2"), *e.lights[1].intensity_sigma);
  EXPECT_DOUBLE_EQ(sigma("diffuse product of light 2, blue"), e.lights[1].diffuse_product_sigma[2]);
  EXPECT_DOUBLE_EQ(sigma("shininess"), *e.sigma.lobes[0].shape);
  EXPECT_DOUBLE_EQ(sigma("ambient product, red"), e.ambient_product_sigma[0]);
  // The direction's ellipse: its larger half-axis is the direction's sigma.
  const double a = sigma("direction of light 2, azimuth"),
               z = sigma("direction of light 2, zenith");
  const Eigen::MatrixXd& r = e.correlation.matrix;
  const double between =
      r(row("direction of light 2, azimuth"), row("direction of light 2, zenith"));
  const double mean = 0.5 * (a * a + z * z), half = 0.5 * (a * a - z * z);
  EXPECT_NEAR(std::sqrt(mean + std::hypot(half, between * a * z)),
              RadToDeg(e.lights[1].direction_sigma), 1e-9);
  EXPECT_LT(r(row("ambient"), row("diffuse")), -0.1) << "what one takes the other gives";
  EXPECT_TRUE((r.diagonal().array() == 1.0).all());
  EXPECT_EQ(r, r.transpose());
}

// The sigma of an inverse distance that is held at 0 is that of an earlier fit, and goes together
// with no other.
TEST(FillFromFit, DistancesThatAreHeldGoWithNoOther) {
  model::ModelChoice choice;
  choice.near = false;
  const ReportCase it(choice);
  const uncertainty::Correlation& correlation = it.estimate.correlation;
  int held = 0;
  for (std::size_t i = 0; i < correlation.quantities.size(); ++i) {
    const uncertainty::CorrelatedQuantity& quantity = correlation.quantities[i];
    if (quantity.quantity != "inverse distance") continue;
    ++held;
    EXPECT_DOUBLE_EQ(quantity.sigma, it.estimate.lights[*quantity.light].inverse_distance_sigma);
    EXPECT_EQ(correlation.matrix.row(static_cast<Eigen::Index>(i)).cwiseAbs().sum(), 1.0);
  }
  EXPECT_EQ(held, 2);
}

// What a highlight may have given: one unknown strength, times each light's intensity.
TEST(FillFromFit, ProductsWithoutAHighlightGoTogether) {
  ReportCase it;
  it.truth.reflectance.lobes[0].model = model::SpecularModel::kNone;
  it.truth.reflectance.lobes[0].strength = 0.0;
  observe::Observations all = RandomObservations(6000, 3, 1, &it.truth).observations;
  AddNoise(0.003, 1, all);
  std::vector<model::Rung> ladder;
  model::ModelChoice choice;
  choice.specular = model::SpecularModel::kNone;
  select::Refined refined = select::Refine(all, it.truth, 0.003, 1.0, choice, ladder);
  refined.specular_sigma = 0.01;
  Estimate e;
  FillFromFit(all, refined, e);
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < e.correlation.quantities.size(); ++i)
    if (e.correlation.quantities[i].quantity == "specular product")
      rows.push_back(static_cast<Eigen::Index>(i));
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_NEAR(e.correlation.matrix(rows[0], rows[1]), 1.0, 1e-12);
  EXPECT_DOUBLE_EQ(e.correlation.quantities[static_cast<std::size_t>(rows[0])].sigma, 0.01);
}

}  // namespace
}  // namespace turnlight::estimator
