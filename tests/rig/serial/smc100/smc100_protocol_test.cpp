// Proves, from conversations after the manual's examples, split everywhere: what is sent and when,
// that TE is asked after all that is set, that silence, late, double and foreign replies complete
// nothing, and that what is no such controller is refused. Does not prove that a controller behaves
// as the manual says.
#include "rig/serial/smc100/smc100_protocol.h"

#include <gtest/gtest.h>

#include "base/document.h"
#include "tests/rig/serial/smc100/smc100_conversation.h"

namespace turnlight::rig::serial::smc100 {
namespace {

TEST(Smc100Protocol, IdentifiesMovesAndProvesTheArrival) {
  EXPECT_EQ(PlaySmc100(kSmc100Ready + R"(
    ! move 12.5
    > 1PA12.50000
    > 1TE
    < 1TE@
    > 1TS
    < 1TS000028
    = moving
    + 25
    > 1TS
    < 1TS000033
    > 1TP
    < 1TP12.4999
    > 1TS
    .
    < 1TS000033
    = idle 12.4999
    + 24
    .
    + 1
    > 1TP
    < 1TP12.5
    > 1TS
    < 1TS000033
    = idle 12.5)"),
            "");
}

TEST(Smc100Protocol, AnOldReadyIsNoArrival) {
  EXPECT_EQ(PlaySmc100(kSmc100Ready + R"(
    + 25
    > 1TP
    ! move 12.5
    > 1PA12.50000
    > 1TE
    # what was asked before the move, and the same once more
    < 1TP0
    < 1TS000033
    < 1TS000033
    .
    < 1TE@
    > 1TS
    < 1TS000033
    > 1TP
    < 1TP3.1
    > 1TS
    < 1TS000028
    = moving
    .)"),
            "");
}

TEST(Smc100Protocol, HomesFromPowerUp) {
  EXPECT_EQ(PlaySmc100(kSmc100Identified + R"(
    < 1TS00000A
    > 1TS
    < 1TS00000a
    = unhomed '0A, NOT REFERENCED from reset: home it first'
    ! move 10
    > 1TS
    < 1TS00000A
    = unhomed 'home it first'
    ! home
    > 1OR
    > 1TE
    < 1TE@
    > 1TS
    < 1TS00001E
    = moving
    + 25
    > 1TS
    < 1TS000032
    > 1TP
    < 1TP0.0001
    > 1TS
    < 1TS000032
    = idle 0.0001
    ! move 10
    > 1PA10.00000
    > 1TE)"),
            "");
}

TEST(Smc100Protocol, AHomedStageGoesToZeroInstead) {
  EXPECT_EQ(PlaySmc100(kSmc100Ready + R"(
    ! home
    > 1PA0.00000
    > 1TE
    < 1TE@
    > 1TS
    < 1TS000028
    + 25
    > 1TS
    < 1TS000033
    > 1TP
    < 1TP0
    > 1TS
    < 1TS000033
    = idle 0)"),
            "");
}

TEST(Smc100Protocol, ARefusedMoveIsToldInTheControllersWords) {
  EXPECT_EQ(PlaySmc100(kSmc100Ready + R"(
    ! move 200
    > 1PA200.00000
    > 1TE
    < 1TEG
    > 1TBG
    < 1TBG Displacement out of limits.
    > 1TS
    < 1TS000033
    = fault 'PA200.00000 is refused: G Displacement out of limits.'
    + 25
    > 1TP
    < 1TP0
    > 1TS
    < 1TS000033
    = fault 'Displacement'
    ! move 10
    > 1PA10.00000
    > 1TE
    < 1TEK
    > 1TBK
    + 500
    > 1TBK
    + 500
    > 1TS
    < 1TS000033
    = fault 'PA10.00000 is refused: K, not allowed in state READY')"),
            "");
}

TEST(Smc100Protocol, AGarbledMoveIsSentAgainOnce) {
  EXPECT_EQ(PlaySmc100(kSmc100Ready + R"(
    ! move 20
    > 1PA20.00000
    > 1TE
    < 1TEA
    = note 'garbled'
    > 1TS
    < 1TS000033
    > 1PA20.00000
    > 1TE
    < 1TEA
    > 1TBA
    < 1TBA Unknown message code or floating point controller address.
    > 1TS
    < 1TS000033
    = fault 'Unknown message code')"),
            "");
}

// Ready at 0 for half a second.
const std::string kStaysAtZero = R"(
    < 1TS000033
    > 1TP
    < 1TP0
    > 1TS
    < 1TS000033
    + 25
    > 1TP
    + 490
    < 1TP0
    > 1TS
    < 1TS000033
)";

TEST(Smc100Protocol, AMoveThatIsIgnoredIsSentAgainOnce) {
  EXPECT_EQ(PlaySmc100(kSmc100Ready + R"(
    ! move 200
    > 1PA200.00000
    > 1TE
    < 1TE@
    > 1TS
    )" + kStaysAtZero + R"(
    = note 'did not set out: sent again'
    > 1PA200.00000
    > 1TE
    < 1TE@
    > 1TS
    )" + kStaysAtZero + R"(
    = fault 'stands at 0.000 degrees instead of 200.000; is that out of its range?'
    # the position is in doubt: the reference is searched anew
    ! home
    = note 'reset'
    > 1RS
    + 500
    > 1TS
    + 500
    > 1TS
    < 1TS00000A
    > 1TS
    < 1TS00000A
    > 1OR
    > 1TE
    < 1TE@
    > 1TS
    < 1TS00001E
    + 25
    > 1TS
    < 1TS000032
    > 1TP
    < 1TP0
    > 1TS
    < 1TS000032
    = idle 0)"),
            "");
}

TEST(Smc100Protocol, HaltStopsAndANewMoveWaitsForIt) {
  EXPECT_EQ(PlaySmc100(kSmc100Ready + R"(
    ! move 90
    > 1PA90.00000
    > 1TE
    < 1TE@
    > 1TS
    < 1TS000028
    ! halt
    > 1ST
    > 1TE
    < 1TE@
    > 1TS
    < 1TS000028
    + 25
    > 1TS
    < 1TS000033
    > 1TP
    < 1TP31.4
    > 1TS
    < 1TS000033
    = idle 31.4
    ! move 90
    > 1PA90.00000
    > 1TE
    < 1TE@
    > 1TS
    < 1TS000028
    ! move 0
    > 1ST
    > 1TE
    < 1TE@
    > 1TS
    < 1TS000028
    + 25
    > 1TS
    < 1TS000033
    > 1PA0.00000
    > 1TE)"),
            "");
}

TEST(Smc100Protocol, AStopThatIsLostIsSentAgain) {
  EXPECT_EQ(PlaySmc100(kSmc100Ready + R"(
    ! move 90
    > 1PA90.00000
    > 1TE
    < 1TE@
    > 1TS
    < 1TS000028
    ! halt
    > 1ST
    > 1TE
    + 500
    > 1TE
    + 500
    > 1TE
    < 1TE@
    > 1TS
    + 100
    < 1TS000028
    > 1ST
    > 1TE)"),
            "");
}

TEST(Smc100Protocol, SilenceEndsTheConversation) {
  EXPECT_EQ(PlaySmc100(kSmc100Ready + R"(
    + 25
    > 1TP
    + 1500
    > 1TP
    > 1TP
    > 1TP
    + 500
    = failed 'the controller at address 1 does not answer to TP for 2.0 s'
    ! move 10
    ! halt
    + 5000
    .)"),
            "");
}

TEST(Smc100Protocol, WhatIsMissingIsSkipped) {
  EXPECT_EQ(PlaySmc100(R"(
    ! connect
    > 7VE
    < 3TS000033
    < 7VE CONEX-AGP 2.0.1
    > 7TS
    # an echo
    < 7TS
    < 7TS00000A
    > 7ID?
    + 500
    > 7ID?
    + 500
    = note 'does not answer to ID?'
    > 7SL?
    < 7SL?
    < 7SL -170.0
    > 7SR?
    < 7sr 170.0
    > 7VA?
    < 7VA4
    > 7AC?
    + 1000
    = note 'AC?'
    > 7AC?
    > 7SU?
    + 1000
    = note 'SU?'
    > 7SU?
    > 7TE
    < 7TED
    = identified 'Newport, CONEX-AGP 2.0.1, '
    > 7TS)",
                       {.address = 7}),
            "");
}

TEST(Smc100Protocol, RefusesWhatIsNotTheController) {
  EXPECT_EQ(PlaySmc100("! connect\n > 1VE\n < 1VE NPC1USB 1.0\n = for-good 'NPC1USB'"), "");
  EXPECT_EQ(PlaySmc100(R"(
    ! connect
    > 1VE
    < Grbl 1.1h ['$' for help]
    + 500
    > 1VE
    < error:1
    + 500
    = for-good 'no SMC100 or CONEX: 'error:1'')"),
            "");
  EXPECT_EQ(PlaySmc100(R"(
    ! connect
    > 1VE
    < 2VE SMC100CC
    + 2000
    > 1VE
    > 1VE
    > 1VE
    = for-good 'does not answer, one at 2 does')"),
            "");
  EXPECT_EQ(PlaySmc100(R"(
    ! connect
    > 1VE
    < 1VE SMC100CC
    > 1TS
    < 1TS000014
    = for-good 'CONFIGURATION')"),
            "");
  EXPECT_EQ(PlaySmc100(R"(
    ! connect
    > 1VE
    < 1VE SMC100CC
    > 1TS
    < 1TS000033
    > 1ID?
    < 1IDTRA25CC
    = for-good ''TRA25CC' is a linear stage')"),
            "");
}

TEST(Smc100Protocol, LimitsAndSpeedsBecomeTraits) {
  Smc100Protocol protocol({});
  protocol.Connect();
  for (const char* reply : {"1VE SMC", "1TS000033", "1IDURS", "1SL-170", "1SR170.5", "1VA20",
                            "1AC80", "1SU0.0005", "1TE@"})
    protocol.Receive(std::string(reply) + "\r\n");
  const auto events = protocol.TakeEvents();
  ASSERT_EQ(events.size(), 1u);
  const StageTraits& traits = std::get<StageIdentified>(events[0]).traits;
  EXPECT_EQ(traits.min_deg, -170.0);
  EXPECT_EQ(traits.max_deg, 170.5);
  EXPECT_EQ(traits.max_speed_deg_s, 20.0);
  EXPECT_EQ(traits.acceleration_deg_s2, 80.0);
  EXPECT_EQ(traits.resolution_deg, 0.0005);
}

TEST(Smc100Protocol, ReadsItsKeys) {
  const auto document = ParseJson(R"({"address": 31})", "rig.json");
  ASSERT_TRUE(document);
  StrictObject keys(*document);
  EXPECT_EQ(ReadSmc100Options(keys).address, 31);
  EXPECT_TRUE(keys.Finish());
  const auto bad = ParseJson(R"({"address": 32})", "rig.json");
  ASSERT_TRUE(bad);
  StrictObject bad_keys(*bad);
  ReadSmc100Options(bad_keys);
  EXPECT_FALSE(bad_keys.Finish());
}

}  // namespace
}  // namespace turnlight::rig::serial::smc100
