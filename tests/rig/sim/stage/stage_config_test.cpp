// Proves that a controller's config is read strictly, with the defaults of its firmware. Does not
// prove that the firmware obeys it.
#include "rig/sim/stage/stage_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace turnlight::rig::sim::stage {
namespace {

using ::testing::HasSubstr;

Result<StageConfig> ParseStage(const std::string& yaml) {
  const auto document = ParseYaml(yaml, "s.yaml");
  if (!document) return Forward(document);
  MockTurntableConfig world;
  world.power_on_deg = 12.0;
  return ReadStageConfig(StrictObject(*document), world);
}

std::string RefusalOfStage(const std::string& yaml) {
  const auto config = ParseStage(yaml);
  return config ? "accepted" : config.error().text;
}

TEST(StageConfig, ReadsEachFirmwareWithItsDefaults) {
  const auto grbl = ParseStage(
      "{firmware: grbl, link: /tmp/g, max_speed_deg_s: 45, axis: A, settings: {22: 0, 133: 720}, "
      "build_info: b, startup: [G21, '']}");
  ASSERT_TRUE(grbl) << grbl.error().text;
  EXPECT_EQ(grbl->baud, 115200);
  EXPECT_TRUE(grbl->reset_on_open);
  EXPECT_EQ(grbl->table.max_speed_deg_s, 45.0);
  EXPECT_EQ(grbl->table.power_on_deg, 12.0);
  EXPECT_EQ(grbl->table.feedback, TableFeedback::kOpenLoop);
  const auto& own = std::get<GrblConfig>(grbl->firmware);
  EXPECT_EQ(own.axis, 'A');
  EXPECT_EQ(own.settings, (std::map<int, double>{{22, 0.0}, {133, 720.0}}));
  EXPECT_EQ(own.startup[0], "G21");
  const auto zaber = ParseStage("{firmware: zaber, link: z, checksum: true, device: 3, baud: 0}");
  ASSERT_TRUE(zaber) << zaber.error().text;
  EXPECT_EQ(zaber->table.serial, "54321");
  EXPECT_EQ(zaber->table.feedback, TableFeedback::kEncoder);
  EXPECT_EQ(zaber->baud, 0);
  EXPECT_FALSE(zaber->reset_on_open);
  EXPECT_TRUE(std::get<ZaberConfig>(zaber->firmware).checksum);
  const auto smc100 = ParseStage("{firmware: smc100, link: s, address: 4, max_deg: 180}");
  ASSERT_TRUE(smc100) << smc100.error().text;
  EXPECT_EQ(smc100->baud, 57600);
  EXPECT_EQ(std::get<Smc100Config>(smc100->firmware).max_deg, 180.0);
}

TEST(StageConfig, RefusesByFileLineKeyAndWhatIsAllowed) {
  EXPECT_THAT(RefusalOfStage("{firmware: marlin, link: l}"),
              HasSubstr("s.yaml:1: firmware: \"marlin\", allowed is one of grbl, zaber, smc100"));
  EXPECT_THAT(RefusalOfStage("{firmware: grbl}"), HasSubstr("link: this key is missing"));
  EXPECT_THAT(RefusalOfStage("{firmware: grbl, link: ''}"), HasSubstr("link"));
  EXPECT_THAT(RefusalOfStage("{firmware: grbl, link: l, baud: 10}"), HasSubstr("baud: 10"));
  EXPECT_THAT(RefusalOfStage("{firmware: grbl, link: l, settings: {999: 1}}"),
              HasSubstr("settings"));
  EXPECT_THAT(RefusalOfStage("{firmware: grbl, link: l, settings: {100: 0}}"),
              HasSubstr("settings"));
  EXPECT_THAT(RefusalOfStage("{firmware: grbl, link: l, feedback: encoder}"),
              HasSubstr("feedback: GRBL has no encoder"));
  EXPECT_THAT(RefusalOfStage("{firmware: grbl, link: l, startup: [G21]}"), HasSubstr("startup"));
  EXPECT_THAT(RefusalOfStage("{firmware: grbl, link: l, device: 1}"), HasSubstr("unknown key"));
  EXPECT_THAT(RefusalOfStage("{firmware: zaber, link: l, serial: T1}"),
              HasSubstr("serial: \"T1\""));
  EXPECT_THAT(RefusalOfStage("{firmware: zaber, link: l, min_deg: 5}"), HasSubstr("min_deg: 5"));
  EXPECT_THAT(RefusalOfStage("{firmware: smc100, link: l, address: 0}"), HasSubstr("address: 0"));
  EXPECT_THAT(RefusalOfStage("{firmware: smc100, link: l, steps_per_deg: 0}"),
              HasSubstr("steps_per_deg"));
}

}  // namespace
}  // namespace turnlight::rig::sim::stage
