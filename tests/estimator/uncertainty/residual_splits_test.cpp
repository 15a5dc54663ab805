// Proves: the parts of a gradient that SplitResiduals gives are those of the parts of the
// observations, with their complements sum to the whole, and there are as many as the views allow.
// Does not prove that sigmas made of them cover errors: unknown_errors_test and bench/studies do.
#include "estimator/uncertainty/residual_splits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "estimator/solve/prediction.h"
#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::uncertainty {
namespace {

using Eigen::Vector3d;

// With noise, and so with residuals; cut into as many views.
RandomObservations InViews(std::size_t views, const model::Scene& truth) {
  RandomObservations random(8 * observe::kTile - 100, 3, 3, &truth);
  observe::Observations& all = random.observations;
  AddNoise(0.01, 5, all);
  all.tile_begin.clear();
  for (std::size_t k = 0; k <= views; ++k) all.tile_begin.push_back(k * all.tiles() / views);
  return random;
}

Eigen::VectorXd GradientOf(const observe::Observations& all, const solve::Solution& solution,
                           const std::function<bool(std::size_t)>& chosen) {
  auto usable = std::make_shared<std::vector<std::uint8_t>>(all.size(), std::uint8_t{0});
  for (std::size_t i = 0; i < all.used; ++i) (*usable)[i] = chosen(i) ? 1 : 0;
  solve::EvaluateOptions options = solution.evaluate;
  options.shadows.usable = std::move(usable);
  return solve::Evaluate(all, solution.scene, options).gradient;
}

// One of views from two on, a second from three on; and five that one view has too.
TEST(SplitResiduals, AsManyHalvesAsTheViewsAllow) {
  const model::Scene truth = TwoLights(0.3, 0.0);
  for (const auto& [views, halves] :
       std::vector<std::pair<std::size_t, std::size_t>>{{1, 5}, {2, 6}, {3, 7}, {4, 7}}) {
    const RandomObservations random = InViews(views, truth);
    const solve::Solution solution = solve::Solve(random.observations, truth, {});
    EXPECT_EQ(SplitResiduals(random.observations, solution).halves.size(), halves) << views;
  }
}

TEST(SplitResiduals, HalvesAndTheirComplementsAreTheWhole) {
  const model::Scene truth = TwoLights(0.3, 0.0);
  const RandomObservations random = InViews(4, truth);
  const observe::Observations& all = random.observations;
  const solve::Solution solution = solve::Solve(all, truth, {});
  ASSERT_EQ(solution.stopped, solve::Stopped::kTolerance);
  const ResidualSplits splits = SplitResiduals(all, solution);
  const auto model = solve::Predict(all, solution.scene, solution.evaluate);
  const auto view = [&](std::size_t i) {
    return static_cast<std::size_t>(
               std::upper_bound(all.tile_begin.begin(), all.tile_begin.end(), i / observe::kTile) -
               all.tile_begin.begin()) -
           1;
  };
  // The halves in their order, each by what its pixels have less of.
  const std::vector<std::function<float(std::size_t)>> values = {
      [&](std::size_t i) { return static_cast<float>(view(i) % 2); },
      [&](std::size_t i) { return view(i) < 2 ? 0.0f : 1.0f; },
      [&](std::size_t i) {
        return all.normal[0][i] * all.mirrored[0][i] + all.normal[1][i] * all.mirrored[1][i] +
               all.normal[2][i] * all.mirrored[2][i];
      },
      [&](std::size_t i) { return model[0][i] + model[1][i] + model[2][i]; },
      [&](std::size_t i) { return all.normal[0][i]; },
      [&](std::size_t i) { return all.normal[1][i]; },
      [&](std::size_t i) { return all.normal[2][i]; }};
  ASSERT_EQ(splits.halves.size(), values.size());
  const Eigen::VectorXd scale = solution.equations.hessian.diagonal().cwiseSqrt();
  for (std::size_t h = 0; h < values.size(); ++h) {
    std::vector<float> sorted;
    for (std::size_t i = 0; i < all.used; ++i) sorted.push_back(values[h](i));
    std::sort(sorted.begin(), sorted.end());
    const float middle = h < 2 ? 0.5f : sorted[sorted.size() / 2];
    const Eigen::VectorXd complement =
        GradientOf(all, solution, [&](std::size_t i) { return values[h](i) >= middle; });
    const Eigen::VectorXd rest = splits.halves[h] + complement - solution.equations.gradient;
    double largest = 0.0;
    for (Eigen::Index k = 0; k < rest.size(); ++k) {
      EXPECT_LT(std::abs(rest[k]), 1e-5 * scale[k] + 1e-12) << "half " << h << " column " << k;
      if (scale[k] > 0.0) largest = std::max(largest, std::abs(splits.halves[h][k]) / scale[k]);
    }
    EXPECT_GT(largest, 1e-3) << "half " << h << " asks for nothing, with noise of 0.01";
  }
}

TEST(SplitResiduals, ClustersAreTheTilesOwnGradients) {
  const model::Scene truth = TwoLights(0.3, 0.0);
  const RandomObservations random = InViews(2, truth);
  const observe::Observations& all = random.observations;
  const solve::Solution solution = solve::Solve(all, truth, {});
  const ResidualSplits splits = SplitResiduals(all, solution);
  ASSERT_EQ(static_cast<std::size_t>(splits.clusters.cols()), all.tiles());
  for (std::size_t t = 0; t < all.tiles(); ++t) {
    const Eigen::VectorXd expected =
        GradientOf(all, solution, [&](std::size_t i) { return i / observe::kTile == t; });
    EXPECT_LT((splits.clusters.col(static_cast<Eigen::Index>(t)) - expected).norm(),
              1e-5 * expected.norm());
  }
}

// Footprints of no extent have the same mean however finely they are sampled, and no edge runs
// through one.
TEST(SplitResiduals, PointsHaveNoFootprintToBeWrongAbout) {
  const model::Scene truth = TwoLights(0.3, 0.0);
  const RandomObservations random = InViews(2, truth);
  const observe::Observations& all = random.observations;
  solve::SolveOptions options;
  options.evaluate.samples_per_side.assign(all.tiles(), 2);
  const solve::Solution solution = solve::Solve(all, truth, options);
  const ResidualSplits splits = SplitResiduals(all, solution);
  const Eigen::VectorXd scale = solution.equations.hessian.diagonal().cwiseSqrt();
  for (Eigen::Index k = 0; k < scale.size(); ++k) {
    EXPECT_LT(std::abs(splits.finer[k]), 1e-4 * scale[k] + 1e-12) << k;
    EXPECT_LT(std::abs(splits.unmodelled.aperture.cross_hessian[k]), 1e-4 * scale[k] + 1e-12) << k;
  }
  EXPECT_EQ(splits.edges.cost, 0.0);
  EXPECT_EQ(splits.edges.gradient.norm(), 0.0);
}

TEST(SplitResiduals, ASmoothSurfaceIsAskedWhetherItIsRough) {
  const model::Scene truth = TwoLights(0.3, 0.0);
  const RandomObservations random = InViews(2, truth);
  const solve::Solution solution = solve::Solve(random.observations, truth, {});
  const ResidualSplits splits = SplitResiduals(random.observations, solution);
  const int roughness = PlainParameters(3, 2).Roughness();
  EXPECT_EQ(solution.equations.hessian(roughness, roughness), 0.0);
  EXPECT_GT(splits.alternatives.hessian(roughness, roughness), 0.0);
  EXPECT_NEAR(splits.alternatives.cost, solution.equations.cost, 1e-3 * solution.equations.cost);
}

}  // namespace
}  // namespace turnlight::estimator::uncertainty
