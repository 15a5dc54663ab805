// Proves: angles and steps are told apart, whatever their sign; a command's words are understood in
// either order; what will move is said with its way, direction and duration. Does not prove: that
// the command line hands a word with a minus over; device_commands_test does.
#include "app/motion_words.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace turnlight::app {
namespace {

using testing::HasSubstr;

bool IsAngle(const std::string& word) { return ParseJogTarget(word).has_value(); }

TEST(MotionWords, AnglesAndSteps) {
  EXPECT_EQ(ParseJogTarget("120")->AngleFrom(30.0), 120.0);
  EXPECT_EQ(ParseJogTarget("-10.5")->AngleFrom(30.0), -10.5);
  EXPECT_EQ(ParseJogTarget("+10")->AngleFrom(30.0), 40.0);
  EXPECT_EQ(ParseJogTarget("+-10")->AngleFrom(30.0), 20.0);
  for (const char* word :
       {"", "+", "-", "1e3", "ten", "10deg", "--10", "++1", "36000.1", "nan", "0x10", "1.2.3"})
    EXPECT_FALSE(ParseJogTarget(word)) << word;
}

TEST(MotionWords, WordsInEitherOrder) {
  for (const auto& words : {std::vector<std::string>{"rig.yaml", "-10"}, {"-10", "rig.yaml"}}) {
    const auto split = SplitWords(words, "", "an angle", IsAngle);
    ASSERT_TRUE(split) << split.error().text;
    EXPECT_EQ(split->config, "rig.yaml");
    EXPECT_EQ(split->other, "-10");
  }
  EXPECT_EQ(SplitWords({"+10", ""}, "rig.yaml", "an angle", IsAngle)->other, "+10");
  EXPECT_EQ(SplitWords({"rig.yaml"}, "", "", IsAngle)->config, "rig.yaml");
  const auto refusal = [](std::vector<std::string> words, const std::string& config) {
    const auto split = SplitWords(words, config, "an angle", IsAngle);
    return split ? "accepted" : split.error().text;
  };
  EXPECT_THAT(refusal({"10"}, ""), HasSubstr("CONFIG or --config"));
  EXPECT_THAT(refusal({"rig.yaml"}, ""), HasSubstr("missing is an angle"));
  EXPECT_THAT(refusal({"rig.yaml", "10"}, "other.yaml"), HasSubstr("rig.yaml: one word too many"));
}

TEST(MotionWords, WhatWillMoveIsSaid) {
  const rig::TableKinematics kinematics{20.0, 100.0};
  EXPECT_EQ(TurnText("grbl at /dev/ttyUSB0", 20.0, 30.0, kinematics),
            "the table grbl at /dev/ttyUSB0 will turn from 20.000 to 30.000 degrees, 10 degrees "
            "counter-clockwise, at 20 deg/s, about 0.7 s");
  EXPECT_THAT(TurnText("mock", 20.0, 19.9, kinematics), HasSubstr("0.1 degrees clockwise"));
  EXPECT_THAT(HomeText("mock"), HasSubstr("the table mock will home"));
}

}  // namespace
}  // namespace turnlight::app
