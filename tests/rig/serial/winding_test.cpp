// Proves: a stage of limited travel is sent to a place that is the same angle, by a way that
// arrives from the right side, or to none.
#include "rig/serial/winding.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace turnlight::rig::serial {
namespace {

using testing::ElementsAre;

TEST(Winding, WithoutLimitsTheAngleGrows) {
  const auto move = PlanWoundMove(3600.0, 3590.0, 0, std::nullopt, 3.0);
  ASSERT_TRUE(move);
  EXPECT_THAT(move->legs_deg, ElementsAre(3600.0));
  EXPECT_EQ(move->turns, 0);
}

TEST(Winding, UnwindsAtTheEndAndArrivesTheWayItWent) {
  const Travel travel{-5.0, 355.0};
  const auto within = PlanWoundMove(350.0, 340.0, 0, travel, 3.0);
  EXPECT_THAT(within->legs_deg, ElementsAre(350.0));
  const auto unwound = PlanWoundMove(360.0, 350.0, 0, travel, 3.0);
  ASSERT_TRUE(unwound);
  EXPECT_THAT(unwound->legs_deg, ElementsAre(-3.0, 0.0));
  EXPECT_EQ(unwound->turns, 1);
  EXPECT_THAT(PlanWoundMove(370.0, 360.0, 1, travel, 3.0)->legs_deg, ElementsAre(10.0));
  // The other way round.
  const auto falling = PlanWoundMove(-10.0, 0.0, 0, travel, 3.0);
  ASSERT_TRUE(falling);
  EXPECT_THAT(falling->legs_deg, ElementsAre(353.0, 350.0));
  EXPECT_EQ(falling->turns, -1);
}

TEST(Winding, GoesNoFurtherPastThanTheTravel) {
  const auto move = PlanWoundMove(360.0, 350.0, 0, Travel{0.0, 359.0}, 3.0);
  ASSERT_TRUE(move);
  EXPECT_THAT(move->legs_deg, ElementsAre(0.0, 0.0));
}

TEST(Winding, WindsBackAsFarAsItCan) {
  const auto move = PlanWoundMove(730.0, 720.0, 0, Travel{-725.0, 725.0}, 3.0);
  ASSERT_TRUE(move);
  EXPECT_EQ(move->turns, 4);
  EXPECT_THAT(move->legs_deg, ElementsAre(-713.0, -710.0));
}

TEST(Winding, RefusesWhatNoTurnReaches) {
  EXPECT_FALSE(PlanWoundMove(175.0, 0.0, 0, Travel{-170.0, 170.0}, 3.0));
  EXPECT_FALSE(PlanWoundMove(180.0, 0.0, 0, Travel{-90.0, 90.0}, 3.0));
}

}  // namespace
}  // namespace turnlight::rig::serial
