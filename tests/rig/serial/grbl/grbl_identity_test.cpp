// Proves: only a GRBL 1.1 or grblHAL with sane settings is moved, and every refusal says which
// setting is wrong and what is allowed. From the firmware's documents. Does not prove: that a real
// board's settings fit its mechanics.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/rig/serial/grbl/grbl_talk.h"

namespace turnlight::rig::serial::grbl {
namespace {

using testing::HasSubstr;

std::string With(std::string settings, const std::string& line, const std::string& instead) {
  const std::size_t at = settings.find(line + "\r\n");
  EXPECT_NE(at, std::string::npos) << line;
  return settings.replace(at, line.size(), instead);
}

void ExpectRefused(const std::string& settings, const std::string& why, GrblOptions options = {}) {
  Talk talk(options);
  talk.Identifies(settings);
  ASSERT_TRUE(talk.failed) << why;
  EXPECT_TRUE(talk.failed->for_good);
  EXPECT_THAT(talk.failed->text, HasSubstr(why));
  EXPECT_FALSE(talk.identified);
}

TEST(GrblIdentity, RefusesSettingsThatWouldMislead) {
  ExpectRefused(With(kSettings, "$13=0", "$13=1"), "$13=1: it reports inches");
  GrblOptions by_switch;
  by_switch.home = Homing::kSwitch;
  ExpectRefused(With(kSettings, "$22=1", "$22=0"), "$22=0: homing is off", by_switch);
  ExpectRefused(With(kSettings, "$100=88.889", "$100=0.000"), "$100=0.000, allowed is");
  ExpectRefused(With(kSettings, "$110=3600.000", "$110=nan"), "$110=nan, allowed is");
  ExpectRefused(With(kSettings, "$120=500.000", "$120=2147483648.000"), "$120=2147483648.000");
  GrblOptions rotary;
  rotary.axis = 'A';
  ExpectRefused(kSettings, "it has 3 axes, and axis A is none of them", rotary);
  GrblOptions lamp;
  lamp.lamp_power = 1.0;
  ExpectRefused(With(kSettings, "$32=0", "$32=1"), "$32=1: in laser mode", lamp);
}

TEST(GrblIdentity, RefusesStartUpLinesWithMotion) {
  for (const char* block : {"G0 X10", "g1x5f100", "$H", "G28", "G91 A3", "G30.0"}) {
    Talk talk;
    talk.Passes(2600);
    talk.Says("ok\r\n");
    talk.Says(kInfo);
    talk.Says(kSettings);
    talk.Says(std::string("$N0=") + block + "\r\n$N1=\r\nok\r\n");
    talk.Says(kOffsets);
    talk.Says("<Idle|MPos:0.000,0.000,0.000|FS:0,0>\r\n");
    ASSERT_TRUE(talk.failed) << block;
    EXPECT_THAT(talk.failed->text, HasSubstr(block));
  }
  EXPECT_FALSE(MovesAnAxis("G21 G54 M5 S0"));
  EXPECT_FALSE(MovesAnAxis("G28.1"));
  EXPECT_FALSE(MovesAnAxis(""));
}

TEST(GrblIdentity, RefusesOtherFirmware) {
  const std::pair<std::string, std::string> others[] = {
      {"[VER:0.9j.20160316:]\r\nok\r\n", "version 0.9j"},
      {"[VER:2.0.20200101:]\r\nok\r\n", "version 2.0"},
      {"echo:Unknown command: \"$I\"\r\nok\r\n", "it said \"echo:Unknown command"},
      {"error:3\r\n", "error:3 (invalid $ statement)"}};
  for (const auto& [answer, why] : others) {
    Talk talk;
    talk.Passes(2600);
    talk.Says("ok\r\n");
    talk.Says(answer);
    talk.Passes(5000);
    ASSERT_TRUE(talk.failed) << answer;
    EXPECT_TRUE(talk.failed->for_good) << answer;
    EXPECT_THAT(talk.failed->text, HasSubstr(why));
  }
}

TEST(GrblIdentity, IsReadFromGrblHalWithItsManySettings) {
  Talk talk;
  talk.Says("\r\nGrblHAL 1.1f ['$' or '$HELP' for help]\r\n");
  talk.Says("ok\r\n");
  talk.Says(
      "[VER:1.1f.20240520:TABLE 7]\r\n[OPT:VNMSHL,35,1024,4,0]\r\n[AXS:4:XYZA]\r\n"
      "[NEWOPT:ENUMS,RT+,ES]\r\n[FIRMWARE:grblHAL]\r\n[DRIVER:iMXRT1062]\r\nok\r\n");
  std::string settings = kSettings;
  settings.insert(settings.size() - 4,
                  "$103=26.66667\r\n$113=7200.000\r\n$123=800.000\r\n$133=0.000\r\n"
                  "$74=my wifi\r\n$376=1\r\n$481=0\r\n");
  talk.Says(settings);
  talk.Says(kStartup);
  talk.Says(kOffsets);
  talk.Says(
      "<Idle|MPos:0.000,0.000,0.000,12.500|Bf:35,1023|FS:0,0|Pn:|WCO:0.000,0.000,0.000,0.000>\r\n");
  ASSERT_TRUE(talk.identified) << (talk.failed ? talk.failed->text : "");
  EXPECT_EQ(talk.identified->identity.vendor, "GrblHAL");
  EXPECT_EQ(talk.identified->identity.serial, "TABLE 7");
}

TEST(GrblIdentity, SettingsWithTheirExplanationsAreRead) {
  const auto setting = ParseSetting("$110=500.000 (x max rate, mm/min)");
  ASSERT_TRUE(setting);
  EXPECT_EQ(setting->number, 110);
  EXPECT_EQ(setting->value, "500.000");
  EXPECT_FALSE(ParseSetting("$N0=G21"));
  EXPECT_FALSE(ParseSetting("$=3"));
  EXPECT_FALSE(ParseSetting("$-3=3"));
}

TEST(GrblIdentity, ABannerThatComesLateBeginsAnew) {
  Talk talk;
  talk.Passes(2600);  // a slow bootloader: the first question got lost or not
  EXPECT_EQ(talk.Heard(), "\n");
  talk.Says(kBannerText);
  EXPECT_EQ(talk.Heard(), "\n");
  talk.Says("ok\r\nok\r\n");  // both answered after all
  EXPECT_EQ(talk.Heard(), "$I\n");
  talk.Says(kInfo);
  EXPECT_EQ(talk.Heard(), "$$\n");
}

TEST(GrblIdentity, ABoardThatACriticalAlarmHoldsIsReset) {
  Talk talk;
  talk.Passes(2500 + 1500 + 1500);
  EXPECT_THAT(talk.Heard(), HasSubstr("\x18"));
  talk.Says(std::string(kBannerText) + "[MSG:'$H'|'$X' to unlock]\r\n");
  talk.Says("ok\r\n");
  EXPECT_THAT(talk.Heard(), HasSubstr("$I\n"));
}

TEST(GrblIdentity, SilenceIsNamed) {
  Talk talk;
  talk.Passes(9000);
  ASSERT_TRUE(talk.failed);
  EXPECT_THAT(talk.failed->text, HasSubstr("no answer"));
  EXPECT_FALSE(talk.failed->for_good);
}

TEST(GrblIdentity, WithoutASwitchTheFirstHomingTakesWhereItStandsAndNoOther) {
  Talk talk;
  talk.Identifies(With(kSettings, "$22=1", "$22=0"), "<Idle|MPos:7.000,0.000,0.000|FS:0,0>\r\n");
  EXPECT_EQ(talk.LastReport()->motion, TableMotion::kUnhomed);
  talk.protocol.Home();
  EXPECT_EQ(talk.Heard(), "$X\n");
  talk.Says("ok\r\n");
  talk.Says("<Idle|MPos:7.000,0.000,0.000|FS:0,0>\r\n");
  EXPECT_DOUBLE_EQ(talk.LastReport()->position_deg, 0.0);
  talk.Heard();
  talk.protocol.MoveTo(10.0);
  EXPECT_THAT(talk.Heard(), HasSubstr("X17.000"));
  talk.Says(kBannerText);  // a brown-out
  talk.Says("<Idle|MPos:0.000,0.000,0.000|FS:0,0>\r\n");
  talk.protocol.Home();
  talk.Passes(250);
  talk.Says("<Idle|MPos:0.000,0.000,0.000|FS:0,0>\r\n");
  const auto report = talk.LastReport();
  EXPECT_EQ(report->motion, TableMotion::kUnhomed);
}

}  // namespace
}  // namespace turnlight::rig::serial::grbl
