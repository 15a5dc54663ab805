// Proves: of a light that the model lacks, the score's slope and curvature are those of the cost
// when it is really added, and the cross-Hessian is that of normal equations which have it as a
// column; under a robust loss the slope is that of the robust cost. Does not prove what sigmas make
// of scores (uncertainty_test).
#include "estimator/uncertainty/score_test.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::uncertainty {
namespace {

// Pictures of two lights with noise, and a third light of intensity q that the model lacks.
struct ScoreCase {
  model::Scene scene = TwoLights();
  observe::Observations pixels;
  solve::Prediction change;  // by one unit of q

  explicit ScoreCase(bool weighted = false) {
    pixels = RandomObservations(3000, 3, 1, &scene).observations;
    AddNoise(0.02, 1, pixels);
    if (weighted) GiveWeights(1, pixels);
    model::Scene alone = WithThird(1.0);
    alone.lights = {alone.lights[2]};
    alone.reflectance.ambient = 0.0;
    change = solve::Predict(pixels, alone, {});
  }
  model::Scene WithThird(double intensity) const {
    model::Scene out = scene;
    out.lights.push_back(
        {Eigen::Vector3d(0.1, -0.9, 0.4).normalized(), 0.1, intensity, Eigen::Vector3d::Ones()});
    return out;
  }
  double CostWith(double intensity, const solve::EvaluateOptions& options) const {
    return solve::EvaluateDouble(pixels, WithThird(intensity), options).cost;
  }
};

void ExpectThoseOfTheCost(const ScoreCase& it) {
  const Score score = ScoreProbe(it.pixels, it.scene, {}).Of(it.change, 1.0);
  constexpr double kStep = 0.05;
  const double up = it.CostWith(kStep, {}), at = it.CostWith(0.0, {}),
               down = it.CostWith(-kStep, {});
  const double scale = std::sqrt(score.curvature * 2.0 * at);
  EXPECT_NEAR(score.slope, (up - down) / (2.0 * kStep), 1e-5 * scale);
  EXPECT_NEAR(score.curvature, (up - 2.0 * at + down) / (kStep * kStep), 1e-4 * score.curvature);
}

void ExpectThatOfAColumn(const ScoreCase& it) {
  const Score score = ScoreProbe(it.pixels, it.scene, {}).Of(it.change, 1.0);
  const solve::NormalEquations with = solve::EvaluateDouble(it.pixels, it.WithThird(0.0), {});
  const model::Parameters parameters = PlainParameters(3, 3);
  const int column = parameters.Intensity(2);
  ASSERT_EQ(score.cross_hessian.size(), (PlainParameters(3, 2).count()));
  for (int k = 0; k < score.cross_hessian.size(); ++k)
    EXPECT_NEAR(score.cross_hessian[k], with.hessian(k, column),
                1e-4 * std::sqrt(with.hessian(k, k) * with.hessian(column, column)))
        << k;
  EXPECT_NEAR(score.curvature, with.hessian(column, column), 1e-5 * score.curvature);
  EXPECT_NEAR(score.slope, with.gradient[column],
              1e-5 * std::sqrt(score.curvature * 2.0 * with.cost));
}

TEST(ScoreProbe, SlopeAndCurvatureAreThoseOfTheCost) {
  ExpectThoseOfTheCost(ScoreCase());
  ExpectThoseOfTheCost(ScoreCase(true));
}

TEST(ScoreProbe, CrossHessianIsThatOfAColumn) {
  ExpectThatOfAColumn(ScoreCase());
  ExpectThatOfAColumn(ScoreCase(true));
}

TEST(ScoreProbe, AUnitIsTimesTheChange) {
  const ScoreCase it;
  const ScoreProbe probe(it.pixels, it.scene, {});
  const Score once = probe.Of(it.change, 1.0), thrice = probe.Of(it.change, 3.0);
  EXPECT_DOUBLE_EQ(thrice.slope, 3.0 * once.slope);
  EXPECT_DOUBLE_EQ(thrice.curvature, 9.0 * once.curvature);
  EXPECT_LT((thrice.cross_hessian - 3.0 * once.cross_hessian).norm(),
            1e-12 * once.cross_hessian.norm());
}

TEST(ScoreProbe, UnderARobustLossTheSlopeIsThatOfItsCost) {
  const ScoreCase it;
  solve::EvaluateOptions robust;
  robust.huber = 0.01;  // beyond which most residuals are
  const Score score = ScoreProbe(it.pixels, it.scene, robust).Of(it.change, 1.0);
  constexpr double kStep = 1e-3;
  const double slope = (it.CostWith(kStep, robust) - it.CostWith(-kStep, robust)) / (2.0 * kStep);
  EXPECT_NEAR(score.slope, slope, 1e-3 * std::abs(slope) + 1e-2);
  const Score squares = ScoreProbe(it.pixels, it.scene, {}).Of(it.change, 1.0);
  EXPECT_LT(score.curvature, 0.7 * squares.curvature);
}

TEST(AdjustedScore, StatisticIsInSquaredSigmas) {
  const AdjustedScore score{.slope = 6.0, .curvature = 4.0, .regression = {}};
  EXPECT_DOUBLE_EQ(score.Statistic(0.25), 36.0);
}

TEST(AddTimes, AddsToEveryValue) {
  solve::Prediction to = {{1.0f, 2.0f}, {3.0f, 4.0f}};
  AddTimes(-0.5, {{2.0f, 4.0f}, {6.0f, 10.0f}}, to);
  EXPECT_EQ(to, (solve::Prediction{{0.0f, 0.0f}, {0.0f, -1.0f}}));
}

}  // namespace
}  // namespace turnlight::estimator::uncertainty
