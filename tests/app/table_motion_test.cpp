// Proves: a move ends with a proof of where the table stands, or with a reason; a motor that does
// not arrive, or that a person wants stopped, is halted, and what became of that is told. Does not
// prove: that a controller obeys; the drivers' tests do.
#include "app/table_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/fake_devices.h"

namespace turnlight::app {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr rig::DeviceTime kLong = std::chrono::seconds(60);
constexpr rig::DeviceTime kShort = std::chrono::milliseconds(50);

class TableMotionTest : public testing::Test {
 protected:
  TableMotionTest() {
    motion_.table = &table_;
    motion_.clock = &clock_;
    motion_.stop = &stop_;
    motion_.note = [this](const std::string& note) { notes_.push_back(note); };
    motion_.watch = [this](const rig::TableState&) { ++watched_; };
    table_.homed = true;
  }
  std::string TurnFault(rig::DeviceTime patience = kLong) {
    const auto state = TurnTable(motion_, 30.0, patience);
    return state ? "arrived" : state.error().text;
  }

  FakeTable table_;
  DeviceClock clock_;
  StopFlag stop_{false};
  TableMotion motion_;
  std::vector<std::string> notes_;
  int watched_ = 0;
};

TEST_F(TableMotionTest, ArrivesAndIsWatched) {
  table_.notes = {"a word"};
  const auto state = TurnTable(motion_, 30.0, kLong);
  ASSERT_TRUE(state) << state.error().text;
  EXPECT_EQ(state->angle_deg, 30.0);
  EXPECT_EQ(watched_, 2);
  EXPECT_THAT(notes_, ElementsAre("a word"));
  EXPECT_EQ(table_.halted, 0);
}

TEST_F(TableMotionTest, ArrivalIsProven) {
  table_.error_deg = 0.06;
  EXPECT_THAT(TurnFault(), HasSubstr("stands at 30.06 deg, allowed is 30 deg to within 0.05"));
  table_.homed = false;
  EXPECT_THAT(TurnFault(), HasSubstr("does not know its position: just switched on"));
  table_.move_fault = "beyond its limits";
  EXPECT_THAT(TurnFault(), HasSubstr("beyond its limits"));
}

TEST_F(TableMotionTest, WhatDoesNotArriveIsHalted) {
  table_.never_arrives = true;
  EXPECT_THAT(TurnFault(kShort), AllOf(HasSubstr("the table still moves after 0.0"),
                                       HasSubstr("the motor was stopped")));
  EXPECT_EQ(table_.halted, 1);
  table_.halts = false;
  EXPECT_THAT(TurnFault(kShort), HasSubstr("the motor could not be stopped: deaf"));
  const auto homed = HomeTable(motion_, kShort);
  ASSERT_FALSE(homed);
  EXPECT_EQ(homed.error().kind, ErrorKind::kDevice);
}

TEST_F(TableMotionTest, StopHaltsTheMotor) {
  table_.never_arrives = true;
  motion_.watch = [this](const rig::TableState&) { stop_ = ++watched_ > 2; };
  const auto state = TurnTable(motion_, 30.0, kLong);
  ASSERT_FALSE(state);
  EXPECT_EQ(state.error().kind, ErrorKind::kInterrupted);
  EXPECT_EQ(table_.halted, 1);
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("the motor was stopped, at 30.000 degrees")));
  EXPECT_FALSE(TurnTable(motion_, 60.0, kLong));  // nothing is begun any more
  EXPECT_THAT(table_.moves, ElementsAre(30.0));
}

TEST_F(TableMotionTest, HomingFindsThePositionOrSaysWhy) {
  table_.homed = false;
  const auto state = HomeTable(motion_, kLong);
  ASSERT_TRUE(state) << state.error().text;
  table_.home_fault = "ALARM:9";
  const auto failed = HomeTable(motion_, kLong);
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().text, "homing failed: ALARM:9");
}

}  // namespace
}  // namespace turnlight::app
