// Proves, from conversations after the manual's examples, split everywhere: every flag has its
// outcome in every phase, rejections are told in the vendor's words, long replies are put together,
// garbage is bounded, and a device that is not the one that is wanted is refused. Does not prove
// that a device sets its flags when it should.
#include <gtest/gtest.h>

#include "tests/rig/serial/zaber/zaber_conversation.h"

namespace turnlight::rig::serial::zaber {
namespace {

TEST(ZaberAnswers, AFaultInAMoveStopsItAndAsksForAHoming) {
  for (const std::string flag : {"FF", "FH", "FV", "FD", "FQ", "FS", "FE", "FT", "WL", "WS", "WM"})
    EXPECT_EQ(PlayZaber(kZaberReady + R"(
      ! move 90
      > /1 1 * move abs 96000
      < @01 1 * OK BUSY -- 0
      + 20
      > /1 1 *
      < @01 1 * OK BUSY )" +
                        flag + R"( 0
      = fault ')" + flag +
                        R"('
      > /1 1 * stop
      < @01 1 * OK IDLE )" +
                        flag + R"( 0
      = fault ')" + flag +
                        R"('
      ! move 90
      + 20
      > /1 1 * get pos
      < @01 1 * OK IDLE -- 4267
      = unhomed ')" + flag +
                        R"('
      ! home
      > /1 1 * warnings clear
      < @01 1 * OK IDLE -- 01 FS
      > /1 1 * home
      < @01 1 * OK BUSY -- 0
      + 20
      > /1 1 *
      < @01 1 * OK IDLE -- 0
      > /1 1 * get pos
      < @01 1 * OK IDLE -- 0
      = idle 0)"),
              "");
}

TEST(ZaberAnswers, AStallWhenItArrivesIsNoArrival) {
  for (const std::string replies :
       {"< @01 1 * OK IDLE FS 0",
        "< @01 1 * OK IDLE -- 0\n > /1 1 * get pos\n < @01 1 * OK IDLE FS 96000"})
    EXPECT_EQ(PlayZaber(kZaberReady + R"(
      ! move 90
      > /1 1 * move abs 96000
      < @01 1 * OK BUSY -- 0
      + 20
      > /1 1 *
      )" + replies + R"(
      = fault 'FS: stalled and stopped')"),
              "");
}

TEST(ZaberAnswers, AnAxisThatAnotherHandMovesIsAFaultUntilItIsMovedAgain) {
  for (const std::string flag : {"NC", "NI"})
    EXPECT_EQ(PlayZaber(kZaberReady + R"(
      + 20
      > /1 1 * get pos
      < @01 1 * OK IDLE )" +
                        flag + R"( 500
      = fault ')" + flag +
                        R"('
      + 20
      > /1 1 * get pos
      < @01 1 * OK IDLE -- 500
      = fault ')" + flag +
                        R"('
      ! move 0
      > /1 1 * warnings clear
      < @01 1 * OK IDLE -- 0
      > /1 1 * move abs 0
      < @01 1 * OK BUSY )" +
                        flag + R"( 0
      + 20
      > /1 1 *
      < @01 1 * OK IDLE -- 0
      > /1 1 * get pos
      < @01 1 * OK IDLE -- 0
      = idle 0)"),
              "");
}

TEST(ZaberAnswers, WhatDisturbedTheAxisBeforeTheLinkWasOpenedIsCleared) {
  EXPECT_EQ(PlayZaber(kZaberIdentified + R"(
    < @01 1 * OK IDLE NI 96000
    > /1 1 * warnings clear
    < @01 1 * OK IDLE NI 01 NI
    > /1 1 * get pos
    < @01 1 * OK IDLE -- 96000
    = idle 90)"),
            "");
}

TEST(ZaberAnswers, AResetLosesTheReference) {
  EXPECT_EQ(PlayZaber(kZaberReady + R"(
    ! move 90
    > /1 1 * move abs 96000
    < @01 1 * OK BUSY -- 0
    + 20
    > /1 1 *
    < @01 1 * OK IDLE WR 0
    = unhomed 'WR: no reference position; the device was reset, or lost it'
    + 20
    > /1 1 * get pos
    < @01 1 * OK IDLE WR 0
    = unhomed 'the device was reset')"),
            "");
}

TEST(ZaberAnswers, ANoticeHidesNoFlagBehindIt) {
  const std::string arrived = R"(
    ! move 90
    > /1 1 * move abs 96000
    < @01 1 * OK BUSY WT 0
    = note 'WT: controller temperature high'
    + 20
    > /1 1 *
    < @01 1 * OK IDLE WT 0
    > /1 1 * get pos
    < @01 1 * OK IDLE WT 96000
    > /1 1 * warnings
    .
)";
  EXPECT_EQ(PlayZaber(kZaberReady + arrived + "< @01 1 * OK IDLE WT 01 WT\n = idle 90"), "");
  EXPECT_EQ(PlayZaber(kZaberReady + arrived + "< @01 1 * OK IDLE WT 02 WT WM\n = fault 'WM'"), "");
  EXPECT_EQ(PlayZaber(kZaberReady + arrived + "< @01 1 * OK IDLE WT 02 WT WR\n = unhomed 'WR'"),
            "");
  EXPECT_EQ(PlayZaber(kZaberReady + arrived + "< @01 1 * OK IDLE WT 02 WT NC\n = fault 'NC'"), "");
}

TEST(ZaberAnswers, RejectionsAreToldInTheVendorsWords) {
  EXPECT_EQ(PlayZaber(kZaberReady + R"(
    ! move 9000
    > /1 1 * move abs 9600000
    < @01 1 * RJ IDLE -- BADDATA
    = fault ''move abs 9600000' is refused: BADDATA: a value is missing or out of range'
    + 20
    > /1 1 * get pos
    < @01 1 * OK IDLE -- 0
    = fault 'BADDATA'
    ! move 9
    > /1 1 * warnings clear
    < @01 1 * RJ IDLE -- BADCOMMAND
    > /1 1 * move abs 9600
    < @01 1 * RJ IDLE -- BADCHECKSUM
    > /1 1 * move abs 9600
    < @01 1 * OK BUSY -- 0
    + 20
    > /1 1 *
    < @01 1 * OK IDLE -- 0
    > /1 1 * get pos
    < @01 1 * OK IDLE -- 9600
    = idle 9
    ! home
    > /1 1 * warnings clear
    < @01 1 * OK IDLE -- 0
    > /1 1 * home
    < @01 1 * RJ IDLE FO DRIVERDISABLED
    = fault ''home' is refused: DRIVERDISABLED: the axis's driver is off')"),
            "");
}

TEST(ZaberAnswers, AMoveThatEndsElsewhereIsAFault) {
  EXPECT_EQ(PlayZaber(kZaberReady + R"(
    ! move 90
    > /1 1 * move abs 96000
    < @01 1 * OK BUSY -- 0
    + 20
    > /1 1 *
    < @01 1 * OK IDLE -- 0
    > /1 1 * get pos
    < @01 1 * OK IDLE -- 90000
    = moving 84.375
    + 500
    > /1 1 *
    < @01 1 * OK IDLE -- 0
    > /1 1 * get pos
    < @01 1 * OK IDLE -- 90000
    = fault 'stands at 84.375 degrees instead of 90.000')"),
            "");
}

TEST(ZaberAnswers, LongRepliesArePutTogether) {
  EXPECT_EQ(PlayZaber(kZaberReady + R"(
    + 20
    > /1 1 * get pos
    < @01 1 * OK IDLE -- 96\
    .
    + 500
    > /1 1 * get pos
    < #01 1 * cont 000
    .)"),
            "");
  EXPECT_EQ(PlayZaber(kZaberReady + R"(
    + 20
    > /1 1 * get pos
    < @01 1 * OK IDLE WV 0
    = note 'WV'
    > /1 1 * warnings
    < @01 1 * OK IDLE WV 04 WV\
    < #02 1 cont WR
    < #01 1 something else
    < #01 1 * cont WT\
    .
    < #01 1 * cont WP WR
    = note 'WT'
    = note 'WP'
    = unhomed 'WR')"),
            "");
}

TEST(ZaberAnswers, GarbageIsDroppedAndCountedAndEndsABadLink) {
  EXPECT_EQ(PlayZaber(kZaberReady + R"(
    + 20
    > /1 1 * get pos
    < 01 1 * OK IDLE -- 96000
    < @01 1 * OK IDLE -- 96000:00
    < @01 1 * OK IDLE -- 9z
    + 20
    > /1 1 * get pos
    # our own line, and nothing
    < /1 1 * get pos
    <
    < @01 1 * OK IDLE -- 96000
    = idle 90
    < ??
    .
    < @01 1 OK IDL
    = failed '5 lines within a minute make no sense, the last '@01 1 OK IDL''
    + 100
    .)"),
            "");
}

TEST(ZaberAnswers, ASettingThatIsMissingIsSkipped) {
  EXPECT_EQ(PlayZaber(R"(
    ! connect
    > /1 0 *
    < @01 0 * OK IDLE WR 0
    > /1 0 * get device.id
    < @01 0 * RJ IDLE WR BADCOMMAND
    > /1 0 * get deviceid
    < @01 0 * OK IDLE WR 30111
    > /1 0 * get system.serial
    < @01 0 * RJ IDLE WR BADCOMMAND
    = note ''system.serial': BADCOMMAND'
    > /1 0 * get version
    < @01 0 * OK IDLE WR 6.14
    > /1 1 * get limit.cycle.dist
    < @01 1 * RJ IDLE WR BADCOMMAND
    = note 'limit.cycle.dist'
    > /1 1 * get limit.min
    < @01 1 * OK IDLE WR 0
    > /1 1 * get limit.max
    < @01 1 * RJ IDLE WR BADCOMMAND
    = note 'limit.max'
    > /1 1 * get maxspeed
    < @01 1 * OK IDLE WR 153600
    > /1 1 * get accel
    < @01 1 * RJ IDLE WR BADCOMMAND
    > /1 1 * get motion.accelonly
    < @01 1 * RJ IDLE WR BADCOMMAND
    = note 'accel'
    = identified 'Zaber, device 30111, firmware 6.14, ''
    > /1 1 * get pos)",
                      {.microsteps_per_turn = 384000.0}),
            "");
}

TEST(ZaberAnswers, RefusesWhatIsNotTheStage) {
  const std::string hello = "! connect\n > /1 0 *\n";
  EXPECT_EQ(PlayZaber(hello + R"(
    < @01 0 * OK IDLE -- 0
    > /1 0 * get device.id
    < @01 0 * RJ IDLE -- BADCOMMAND
    > /1 0 * get deviceid
    < @01 0 * RJ IDLE -- BADCOMMAND
    = for-good 'does not say what it is')"),
            "");
  const std::string first = kZaberReady.substr(0, kZaberReady.find("> /1 1"));
  EXPECT_EQ(PlayZaber(first + R"(
    > /1 1 * get limit.cycle.dist
    < @01 1 * RJ IDLE -- BADAXIS
    = for-good 'device 1 has no axis 1 (BADAXIS: there is no axis of this number)')"),
            "");
  EXPECT_EQ(PlayZaber(hello + R"(
    < Grbl 1.1h ['$' for help]
    + 500
    > /1 0 *
    < error:2
    + 500
    = for-good 'no Zaber device that speaks ASCII: 'error:2'')"),
            "");
  EXPECT_EQ(PlayZaber(hello + R"(
    < @02 0 * OK IDLE -- 0
    + 500
    > /1 0 *
    + 500
    > /1 0 *
    + 500
    > /1 0 *
    + 500
    = for-good 'device 1 does not answer, device 2 does')"),
            "");
}

}  // namespace
}  // namespace turnlight::rig::serial::zaber
