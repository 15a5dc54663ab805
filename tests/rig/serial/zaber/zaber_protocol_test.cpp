// Proves, from conversations after the manual's examples, split everywhere: what is sent and when,
// that silence, late, stale and foreign replies complete nothing, and that what is no such device
// is refused. Does not prove that a device behaves as the manual says.
#include "rig/serial/zaber/zaber_protocol.h"

#include <gtest/gtest.h>

#include "tests/rig/serial/zaber/zaber_conversation.h"

namespace turnlight::rig::serial::zaber {
namespace {

TEST(ZaberProtocol, IdentifiesMovesAndProvesTheArrival) {
  EXPECT_EQ(PlayZaber(kZaberReady + R"(
    ! move 90
    > /1 1 * move abs 96000
    < @01 1 * OK BUSY -- 0
    = moving
    + 20
    > /1 1 *
    < @01 1 * OK BUSY -- 0
    = moving
    + 20
    > /1 1 *
    < @01 1 * OK IDLE -- 0
    > /1 1 * get pos
    .
    < @01 1 * OK IDLE -- 96000
    = idle 90
    + 19
    .
    + 1
    > /1 1 * get pos
    < @01 1 * OK IDLE -- 96000
    = idle 90
    ! move -12.3456
    > /1 1 * move abs -13169)"),
            "");
}

TEST(ZaberProtocol, HomesFromPowerUp) {
  EXPECT_EQ(PlayZaber(kZaberIdentified + R"(
    < @01 1 * OK IDLE WR 0
    = unhomed 'WR: no reference position; home it first'
    ! move 10
    + 20
    > /1 1 * get pos
    < @01 1 * OK IDLE WR 0
    = unhomed 'WR'
    ! home
    > /1 1 * warnings clear
    < @01 1 * OK IDLE WR 0
    > /1 1 * home
    < @01 1 * OK BUSY WR 0
    + 20
    > /1 1 *
    < @01 1 * OK BUSY WR 0
    = moving
    + 20
    > /1 1 *
    < @01 1 * OK IDLE -- 0
    > /1 1 * get pos
    < @01 1 * OK IDLE -- 0
    = idle 0
    ! move 10
    > /1 1 * move abs 10667)"),
            "");
}

TEST(ZaberProtocol, AHomingThatFindsNoReferenceIsNone) {
  EXPECT_EQ(PlayZaber(kZaberReady + R"(
    ! home
    > /1 1 * warnings clear
    < @01 1 * OK IDLE -- 0
    > /1 1 * home
    < @01 1 * OK BUSY WH 0
    + 20
    > /1 1 *
    < @01 1 * OK IDLE WH 0
    > /1 1 * get pos
    < @01 1 * OK IDLE WH 12
    = unhomed 'without a reference position')"),
            "");
}

TEST(ZaberProtocol, HaltStopsAndTheInterruptionIsItsOwn) {
  EXPECT_EQ(PlayZaber(kZaberReady + R"(
    ! move 90
    > /1 1 * move abs 96000
    < @01 1 * OK BUSY -- 0
    ! halt
    > /1 1 * stop
    < @01 1 * OK BUSY NI 0
    + 20
    > /1 1 *
    < @01 1 * OK IDLE NI 0
    > /1 1 * get pos
    < @01 1 * OK IDLE NI 4267
    > /1 1 * warnings clear
    < @01 1 * OK IDLE NI 1 NI
    > /1 1 *
    < @01 1 * OK IDLE -- 0
    > /1 1 * get pos
    < @01 1 * OK IDLE -- 4267
    = idle 4.0003125)"),
            "");
}

TEST(ZaberProtocol, ANewCommandReplacesAMove) {
  EXPECT_EQ(PlayZaber(kZaberReady + R"(
    ! move 90
    > /1 1 * move abs 96000
    < @01 1 * OK BUSY -- 0
    ! move 0
    > /1 1 * move abs 0
    < @01 1 * OK BUSY NI 0
    + 20
    > /1 1 *
    < @01 1 * OK IDLE NI 0
    > /1 1 * get pos
    < @01 1 * OK IDLE NI 0
    > /1 1 * warnings clear
    < @01 1 * OK IDLE -- 0
    > /1 1 *
    < @01 1 * OK IDLE -- 0
    > /1 1 * get pos
    < @01 1 * OK IDLE -- 0
    = idle 0)"),
            "");
}

TEST(ZaberProtocol, RepliesOfOthersAndStaleOnesCompleteNothing) {
  EXPECT_EQ(PlayZaber(kZaberReady + R"(
    ! move 90
    > /1 1 * move abs 96000
    # another device, another axis, the poll before, no id at all, information and an alert
    < @02 1 * OK IDLE -- 0
    < @01 2 * OK IDLE -- 0
    < @01 1 09 OK IDLE -- 0
    < @01 1 OK IDLE -- 0
    < #01 1 Idle
    < !01 1 IDLE --
    .
    < @01 1 * OK BUSY -- 0
    < @01 1 * OK BUSY -- 0
    = moving
    .
    # an alert is no arrival: the state is asked for
    < !01 1 IDLE --
    + 1
    > /1 1 *
    < @01 1 * OK BUSY -- 0
    = moving
    .)"),
            "");
}

TEST(ZaberProtocol, ALostReplyToAMoveIsNoReasonToMoveTwice) {
  EXPECT_EQ(PlayZaber(kZaberReady + R"(
    ! move 90
    > /1 1 * move abs 96000
    + 500
    = note 'no reply to 'move abs 96000' yet'
    > /1 1 *
    < @01 1 * OK BUSY -- 0
    = moving
    + 20
    > /1 1 *
    < @01 1 * OK IDLE -- 0
    > /1 1 * get pos
    < @01 1 * OK IDLE -- 96000
    = idle 90)"),
            "");
}

TEST(ZaberProtocol, ALostMoveIsSentAgainOnce) {
  EXPECT_EQ(PlayZaber(kZaberReady + R"(
    ! move 90
    > /1 1 * move abs 96000
    + 500
    = note 'no reply'
    > /1 1 *
    < @01 1 * OK IDLE -- 0
    > /1 1 * get pos
    < @01 1 * OK IDLE -- 0
    = note 'sent again'
    > /1 1 * move abs 96000
    + 500
    = note 'no reply'
    > /1 1 *
    < @01 1 * OK IDLE -- 0
    > /1 1 * get pos
    < @01 1 * OK IDLE -- 0
    = fault ''move abs' was sent twice and not answered')"),
            "");
}

TEST(ZaberProtocol, ALateReplyToAMoveCounts) {
  EXPECT_EQ(PlayZaber(kZaberReady + R"(
    ! move 90
    > /1 1 * move abs 96000
    + 500
    = note 'no reply'
    > /1 1 *
    # ids count from 0: 10 were used until the first position
    < @01 1 10 OK BUSY -- 0
    .
    < @01 1 * OK IDLE -- 0
    > /1 1 * get pos
    < @01 1 * OK IDLE -- 0
    = moving
    + 20
    > /1 1 *)"),
            "");
}

TEST(ZaberProtocol, SilenceEndsTheConversation) {
  EXPECT_EQ(PlayZaber(kZaberReady + R"(
    + 20
    > /1 1 * get pos
    + 500
    > /1 1 * get pos
    + 500
    > /1 1 * get pos
    + 500
    > /1 1 * get pos
    .
    + 500
    = failed 'device 1 does not answer to 'get pos' for 2.0 s'
    + 5000
    ! move 10
    ! home
    ! halt
    < @01 1 * OK IDLE -- 0
    .)"),
            "");
}

TEST(ZaberProtocol, AReplyToAnEarlierTryIsGoodToo) {
  EXPECT_EQ(PlayZaber(kZaberReady + R"(
    + 20
    > /1 1 * get pos
    + 500
    > /1 1 * get pos
    # 10 was the first try
    < @01 1 10 OK IDLE -- 0
    = idle 0
    < @01 1 * OK IDLE -- 96000
    .)"),
            "");
}

TEST(ZaberProtocol, ADeviceWithoutIdsIsWaitedFor) {
  std::string script = kZaberReady;
  for (std::size_t at; (at = script.find("* OK")) != script.npos;) script.erase(at, 2);
  EXPECT_EQ(PlayZaber(script + R"(
    + 20
    > /1 1 * get pos
    ! move 90
    .
    # the answer to the poll, not to the move
    < @01 1 OK IDLE -- 0
    > /1 1 * move abs 96000
    < @01 1 OK BUSY -- 0
    + 20
    > /1 1 *
    < @01 1 OK IDLE -- 0
    > /1 1 * get pos
    < @01 1 OK IDLE -- 96000
    = idle 90)"),
            "");
}

TEST(ZaberProtocol, ConnectForgetsEverything) {
  EXPECT_EQ(PlayZaber(kZaberReady + R"(
    ! move 90
    > /1 1 * move abs 96000
    < @01 1 * OK BUSY FS 0
    )" + "= fault 'FS'\n> /1 1 * stop\n" +
                      kZaberReady),
            "");
}

}  // namespace
}  // namespace turnlight::rig::serial::zaber
