// Proves, where the problem is a mean, in closed form: where more than noise is left of a single
// view, what goes together over squares of a grid counts as so many values as there are squares,
// which tiles do not see; of independent values nothing changes. Does not prove it for what goes
// together over more than a square, or over parts of several.
#include "estimator/uncertainty/clusters.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estimator/uncertainty/uncertainty.h"
#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::uncertainty {
namespace {

constexpr std::size_t kSide = 128, kSquares = 8;
constexpr double kNoise = 0.001, kOffset = 0.05;

// sigma_stat of the mean of a grey picture of ambient light alone, with an offset of its own for
// each square. explained: by noise, as far as the fit knows.
double SigmaOfMean(double offset, bool explained) {
  model::Scene scene;
  scene.reflectance.ambient = 0.5;
  scene.reflectance.lobes[0].model = model::SpecularModel::kNone;
  observe::Observations all = RandomObservations(kSide * kSide, 1, 1, &scene).observations;
  all.width = kSide;
  AddNoise(kNoise, 1, all);
  const RandomStream random(8, 8);
  for (std::size_t i = 0; i < kSide * kSide; ++i) {
    const std::size_t row = i / kSide * kSquares / kSide, column = i % kSide * kSquares / kSide;
    all.radiance[0][i] += static_cast<float>(offset * random.Normal(row * kSquares + column));
  }
  solve::SolveOptions options;
  if (!explained) options.evaluate.huber = 10.0 * kOffset;  // no residual is as large
  const solve::Solution solution = solve::Solve(all, scene, options);
  return EstimateUncertainty(solution, all, {}, 1.0, SplitResiduals(all, solution)).stat.ambient;
}

TEST(AllowForClusters, SquaresThatGoTogether) {
  const double expected = kOffset / static_cast<double>(kSquares);
  EXPECT_NEAR(SigmaOfMean(kOffset, false), expected, 0.3 * expected);
  EXPECT_LT(SigmaOfMean(kOffset, true), 0.6 * expected);
}

TEST(AllowForClusters, IndependentValues) {
  const double expected = kNoise / static_cast<double>(kSide);
  EXPECT_NEAR(SigmaOfMean(0.0, false), expected, 0.05 * expected);
}

}  // namespace
}  // namespace turnlight::estimator::uncertainty
