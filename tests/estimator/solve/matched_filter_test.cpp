// Proves: a light taken out of a known scene is the best of those that the filter ranks, within
// half the lattice's spacing and with its strength; the gain is the fall of the cost when it is
// really added; the two ways to find it agree; from the whole scene nothing is missed. Does not
// prove that lights are found where shadows or lobes are in the way (unknown_errors_test).
#include "estimator/solve/matched_filter.h"

#include <gtest/gtest.h>

#include "estimator/solve/normal_equations.h"
#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::solve {
namespace {

using Eigen::Vector3d;

constexpr double kSpacingDeg = 14.0;

struct MissingCase {
  model::Scene known = TwoLights();
  model::Light missing;
  observe::Observations pixels;

  explicit MissingCase(const Vector3d& from) {
    missing = {from.normalized(), 0.05, 0.1, Vector3d::Ones()};
    model::Scene truth = known;
    truth.lights.push_back(missing);
    pixels = RandomObservations(4000, 3, 3, &truth).observations;
  }
};

TEST(MatchedFilter, TheMissingLightIsTheBest) {
  for (const Vector3d& from : {Vector3d(0.1, -0.8, 0.4), Vector3d(0.9, 0.1, 0.2)}) {
    const MissingCase it(from);
    const auto ranked = RankMissingLights(it.pixels, it.known, {});
    ASSERT_GT(ranked.size(), 10u);
    EXPECT_LT(AngleDeg(ranked[0].light.direction, it.missing.direction), kSpacingDeg / 1.4);
    EXPECT_NEAR(ranked[0].light.intensity, 0.1, 0.03);
    for (std::size_t i = 1; i < ranked.size(); ++i) EXPECT_LE(ranked[i].gain, ranked[i - 1].gain);
    const auto most = MostMissingLight(it.pixels, it.known);
    ASSERT_TRUE(most.has_value());
    EXPECT_EQ(most->direction, ranked[0].light.direction);
    EXPECT_NEAR(most->intensity, ranked[0].light.intensity, 1e-4 * most->intensity);
  }
}

TEST(MatchedFilter, TheGainIsTheFallOfTheCost) {
  const MissingCase it({0.1, -0.8, 0.4});
  const auto ranked = RankMissingLights(it.pixels, it.known, {});
  const double before = EvaluateDouble(it.pixels, it.known, {}).cost;
  for (const std::size_t rank : {std::size_t{0}, std::size_t{5}, ranked.size() - 1}) {
    model::Scene more = it.known;
    more.lights.push_back(ranked[rank].light);
    EXPECT_NEAR(before - EvaluateDouble(it.pixels, more, {}).cost, ranked[rank].gain,
                1e-3 * ranked[rank].gain + 1e-6 * before);
  }
}

// Where the model is brighter than the pictures everywhere no light helps.
TEST(MatchedFilter, NothingIsMissedWhereAllIsTooBright) {
  const model::Scene truth = TwoLights();
  const observe::Observations pixels = RandomObservations(2000, 3, 3, &truth).observations;
  model::Scene brighter = truth;
  brighter.reflectance.ambient += 0.2;
  EXPECT_TRUE(RankMissingLights(pixels, brighter, {}).empty());
  EXPECT_FALSE(MostMissingLight(pixels, brighter).has_value());
  // From the truth itself only rounding is left.
  const auto ranked = RankMissingLights(pixels, truth, {});
  EXPECT_LT(ranked.empty() ? 0.0 : ranked[0].light.intensity, 1e-5);
}

}  // namespace
}  // namespace turnlight::estimator::solve
