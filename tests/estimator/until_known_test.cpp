// Proves: a capture stops early only where the sigma was reached over a quarter turn, in three
// estimates at least, and the lights stayed; after the plan it ends with what was reached, with as
// many keyframes as are allowed, or where more do not help, and says so. Does not prove which
// keyframes it adds: next_view_test and tests/app/run_until_test.cpp do.
#include "estimator/until_known.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/angles.h"
#include "tests/estimator/random_observations.h"
#include "tests/estimator/tiny_ball.h"

namespace turnlight::estimator {
namespace {

using testing::HasSubstr;
using Kind = UntilDecision::Kind;

constexpr double kWantedDeg = 0.1;

// Lights in the xz plane, so many degrees from the zenith.
Estimate LightsAt(const std::vector<double>& angles_deg, double sigma_deg) {
  Estimate out;
  for (const double angle_deg : angles_deg) {
    LightEstimate& light = out.lights.emplace_back();
    const double angle = DegToRad(angle_deg);
    light.light.direction = {std::sin(angle), 0.0, std::cos(angle)};
    light.direction_sigma = DegToRad(sigma_deg);
  }
  return out;
}

class Until : public testing::Test {
 protected:
  // Keyframes 10 degrees apart.
  Kind Take(UntilKnown& until, const Estimate& estimate, bool looked = true) {
    until.Took(10.0 * static_cast<double>(until.taken()), looked, &estimate);
    return until.Early().kind;
  }
  UntilDecision After(const UntilKnown& until, const Estimate* estimate) {
    const TinyBall ball(TwoLights(), 1);
    return until.After(estimate, {}, ball.geometry, ball.rays, {});
  }
  UntilKnown until_{{DegToRad(kWantedDeg), 36, 2}};
  const Estimate good_ = LightsAt({20.0, 50.0}, 0.09);
};

TEST_F(Until, StopsEarlyWhereItHeldOverAQuarterTurn) {
  for (int k = 0; k < 9; ++k) EXPECT_EQ(Take(until_, good_), Kind::kGoOn) << k;
  EXPECT_EQ(Take(until_, good_), Kind::kEnd);
  EXPECT_EQ(until_.Early().code, "early");
  EXPECT_THAT(until_.Early().words, HasSubstr("0.1\u00b0 over the last 90\u00b0 of the turn"));
  EXPECT_THAT(until_.Early().words, HasSubstr("10 of 36 keyframes"));
}

TEST_F(Until, BeginsAnewWhereASigmaIsNotReachedOrALightMovesOrComes) {
  for (const Estimate& other :
       {LightsAt({20.0, 50.0}, 0.11), LightsAt({20.0, 50.3}, 0.09), LightsAt({20.0}, 0.09),
        LightsAt({}, 0.0), LightsAt({20.0, 50.0}, NAN)}) {
    UntilKnown until({DegToRad(kWantedDeg), 36, 2});
    for (int k = 0; k < 9; ++k) Take(until, good_);
    EXPECT_EQ(Take(until, other), Kind::kGoOn);
    for (int k = 0; k < 9; ++k) EXPECT_EQ(Take(until, good_), Kind::kGoOn);
    EXPECT_EQ(Take(until, good_), Kind::kEnd);
  }
}

TEST_F(Until, NoEstimateBeginsAnewAndOneThatWasNotAskedForDoesNot) {
  for (int k = 0; k < 5; ++k) Take(until_, good_);
  for (int k = 0; k < 4; ++k) EXPECT_EQ(Take(until_, good_, false), Kind::kGoOn);
  EXPECT_EQ(Take(until_, good_), Kind::kEnd);
  until_.Took(100.0, true, nullptr);
  EXPECT_EQ(until_.Early().kind, Kind::kGoOn);
}

// 120 degrees apart, a quarter turn is two keyframes.
TEST_F(Until, TakesThreeEstimatesAtLeast) {
  UntilKnown until({DegToRad(kWantedDeg), 36, 2});
  for (const double angle_deg : {0.0, 120.0}) {
    until.Took(angle_deg, true, &good_);
    EXPECT_EQ(until.Early().kind, Kind::kGoOn);
  }
  until.Took(240.0, true, &good_);
  EXPECT_EQ(until.Early().kind, Kind::kEnd);
}

TEST_F(Until, AfterThePlanItEndsAsItCan) {
  const Estimate bad = LightsAt({20.0, 50.0}, 0.3);
  for (int k = 0; k < 36; ++k) Take(until_, bad);
  ASSERT_TRUE(until_.plan_is_done());
  EXPECT_EQ(After(until_, nullptr).code, "no-estimate");
  EXPECT_EQ(After(until_, &good_).code, "reached");
  Estimate changing = bad;
  changing.fit.scene.lights.resize(1);
  changing.fit.scene.lights[0].factors = {0.9, 1.1};
  EXPECT_EQ(After(until_, &changing).code, "no-forecast");
  Take(until_, bad);
  Take(until_, bad);
  const UntilDecision most = After(until_, &bad);
  EXPECT_EQ(most.code, "most-extra");
  EXPECT_THAT(most.words, HasSubstr("2 more keyframes were taken"));
  EXPECT_THAT(most.words, HasSubstr("known to 0.3\u00b0, not to 0.1\u00b0"));
}

// No candidates, and a part of the sigma that stays.
TEST_F(Until, SaysWhatDoesNotShrink) {
  Estimate estimate = LightsAt({20.0}, 0.3);
  for (int k = 0; k < 36; ++k) Take(until_, estimate);
  uncertainty::DirectionForecast& forecast = estimate.fit.directions;
  forecast.unknowns = {0, 1};
  forecast.hessian = Eigen::Matrix2d::Identity() * 1e8;
  forecast.variance = 1.0;
  forecast.lights.resize(1);
  forecast.lights[0].jacobian = Eigen::Matrix2d::Identity();
  EXPECT_EQ(After(until_, &estimate).code, "no-view");
  const double floor = DegToRad(0.25);
  forecast.lights[0].floor = Eigen::Matrix2d::Identity() * floor * floor;
  uncertainty::BudgetItem item{uncertainty::NormalsWords(), {}};
  item.sigma.lights.resize(1);
  item.sigma.lights[0].direction = floor;
  estimate.budget.push_back(item);
  const UntilDecision decision = After(until_, &estimate);
  EXPECT_EQ(decision.code, "floor");
  EXPECT_THAT(decision.words, HasSubstr("0.25\u00b0 of it stay whatever is taken"));
  EXPECT_THAT(decision.words, HasSubstr("normals of the target"));
}

}  // namespace
}  // namespace turnlight::estimator
