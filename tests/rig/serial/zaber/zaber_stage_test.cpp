// Proves: the settings become a stage in degrees by the manual's units; a stage that does not turn,
// or turns otherwise than the config says, is refused; the keys are read strictly.
#include "rig/serial/zaber/zaber_stage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/document.h"

namespace turnlight::rig::serial::zaber {
namespace {

using testing::HasSubstr;

SettingValues RotaryStage() {
  return {{"device.id", "50321"},   {"system.serial", "71234"},
          {"version", "7.38"},      {"limit.cycle.dist", "384000"},
          {"limit.min", "-384000"}, {"limit.max", "768000"},
          {"maxspeed", "52429"},    {"accel", "17"}};
}

TEST(ZaberStage, ReadsTheManualsUnits) {
  const auto stage = IdentifyStage(RotaryStage(), {});
  ASSERT_TRUE(stage) << stage.error().text;
  EXPECT_DOUBLE_EQ(stage->microsteps_per_deg, 384000.0 / 360.0);
  const StageTraits& traits = stage->identified.traits;
  EXPECT_DOUBLE_EQ(*traits.min_deg, -360.0);
  EXPECT_DOUBLE_EQ(*traits.max_deg, 720.0);
  EXPECT_DOUBLE_EQ(traits.resolution_deg, 360.0 / 384000.0);
  // 52429 / 1.6384 = 32000 microsteps a second; 17 * 10000 / 1.6384 = 103760 a second squared.
  EXPECT_NEAR(*traits.max_speed_deg_s, 30.0, 1e-3);
  EXPECT_NEAR(*traits.acceleration_deg_s2, 97.275, 1e-3);
  EXPECT_EQ(stage->identified.identity.serial, "71234");
}

TEST(ZaberStage, WhatIsMissingIsLeftOpen) {
  const auto stage = IdentifyStage({{"device.id", "1"}}, {.microsteps_per_turn = 36000.0});
  ASSERT_TRUE(stage) << stage.error().text;
  EXPECT_FALSE(stage->identified.traits.min_deg || stage->identified.traits.max_speed_deg_s);
  EXPECT_DOUBLE_EQ(stage->microsteps_per_deg, 100.0);
}

TEST(ZaberStage, RefusesWhatDoesNotTurnOrTurnsOtherwise) {
  SettingValues linear = RotaryStage();
  linear.erase("limit.cycle.dist");
  EXPECT_THAT(IdentifyStage(linear, {}).error().text, HasSubstr("no rotary stage"));
  for (const char* cycle : {"0", "-5", "nan", "x", "1e300"}) {
    linear["limit.cycle.dist"] = cycle;
    EXPECT_FALSE(IdentifyStage(linear, {})) << cycle;
  }
  EXPECT_THAT(IdentifyStage(RotaryStage(), {.microsteps_per_turn = 384001.0}).error().text,
              HasSubstr("microsteps_per_turn is 384001"));
  SettingValues twisted = RotaryStage();
  twisted["limit.max"] = "-384000";
  EXPECT_THAT(IdentifyStage(twisted, {}).error().text, HasSubstr("limit.max"));
}

TEST(ZaberStage, ReadsItsKeys) {
  const auto document =
      ParseJson(R"({"device": 2, "axis": 3, "microsteps_per_turn": 384000})", "rig.json");
  ASSERT_TRUE(document);
  StrictObject keys(*document);
  const ZaberOptions options = ReadZaberOptions(keys);
  EXPECT_TRUE(keys.Finish());
  EXPECT_EQ(options.device, 2);
  EXPECT_EQ(options.axis, 3);
  EXPECT_EQ(options.microsteps_per_turn, 384000.0);
  for (const char* text :
       {R"({"device": 0})", R"({"axis": 10})", R"({"microsteps_per_turn": 1})"}) {
    const auto bad = ParseJson(text, "rig.json");
    ASSERT_TRUE(bad);
    StrictObject bad_keys(*bad);
    ReadZaberOptions(bad_keys);
    EXPECT_FALSE(bad_keys.Finish()) << text;
  }
}

}  // namespace
}  // namespace turnlight::rig::serial::zaber
