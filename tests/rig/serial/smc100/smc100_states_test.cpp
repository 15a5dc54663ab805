// Proves, from conversations after the manual's states and errors, split everywhere: every state
// and every error of the positioner has its outcome in every phase, and one altered reply is none.
// Does not prove that a controller sets its states when it should.
#include <gtest/gtest.h>

#include "base/format.h"
#include "tests/rig/serial/smc100/smc100_conversation.h"

namespace turnlight::rig::serial::smc100 {
namespace {

const std::string kMovingTo90 = R"(
    ! move 90
    > 1PA90.00000
    > 1TE
    < 1TE@
    > 1TS
    < 1TS000028
    = moving
    + 25
    > 1TS
)";

TEST(Smc100States, DoneMeansReadyAndNothingElse) {
  for (unsigned state = 0; state < 256; ++state) {
    const std::string reply = Format("< 1TS0000%02X\n", state);
    const std::string script = kSmc100Ready + kMovingTo90 + reply;
    switch (KindOf(state)) {
      case StateKind::kReady:
        EXPECT_EQ(PlaySmc100(script + "> 1TP\n < 1TP90\n > 1TS\n" + reply + "= idle 90"), "")
            << state;
        break;
      case StateKind::kMoving:
      case StateKind::kHoming:
        EXPECT_EQ(PlaySmc100(script + ". \n + 25\n > 1TS\n"), "") << state;
        break;
      case StateKind::kUnreferenced:
        EXPECT_EQ(PlaySmc100(script + "> 1TS\n" + reply + "= unhomed 'lost its reference'"), "")
            << state;
        break;
      default:
        EXPECT_EQ(PlaySmc100(script + "> 1TS\n" + reply + Format("= fault 'state %02X'", state)),
                  "")
            << state;
    }
  }
}

TEST(Smc100States, OneAlteredReplyIsNoTrouble) {
  for (const std::string reply : {"1TS00000A", "1TS00003C", "1TS0000AA"})
    EXPECT_EQ(PlaySmc100(kSmc100Ready + kMovingTo90 + "< " + reply + R"(
      > 1TS
      < 1TS000028
      = moving
      + 25
      > 1TS
      < 1TS000033
      > 1TP
      < 1TP90
      > 1TS
      < 1TS000033
      = idle 90)"),
              "");
  EXPECT_EQ(PlaySmc100(kSmc100Ready + kMovingTo90 + R"(
    < 1TS00003
    < 1TS0000333
    < 1TX000033
    < 2TS000033
    .
    < 1TS000028
    + 25
    > 1TS
    < 1TS000033
    > 1TP
    < 1TP9O
    < 1TP90
    > 1TS
    < 1TS000028
    = moving
    .)"),
            "");
}

TEST(Smc100States, ErrorsOfThePositionerAreTold) {
  for (int bit = 2; bit < 16; ++bit) {
    const unsigned errors = 1u << bit;
    EXPECT_EQ(PlaySmc100(kSmc100Ready + kMovingTo90 + Format("< 1TS%04X33\n", errors) +
                         "= fault '" + ErrorsInWords(errors) + ", state 33, READY from MOVING'"),
              "");
    EXPECT_EQ(PlaySmc100(kSmc100Ready + kMovingTo90 + Format("< 1TS%04X28\n", errors) +
                         "> 1ST\n > 1TE\n = fault '" + ErrorsInWords(errors) + "'"),
              "");
  }
  EXPECT_EQ(PlaySmc100(kSmc100Ready + kMovingTo90 + R"(
    < 1TS00200F
    > 1TS
    < 1TS00200F
    = unhomed '0F, NOT REFERENCED from MOVING (following error)')"),
            "");
}

TEST(Smc100States, ALimitSwitchAtRestIsNoted) {
  EXPECT_EQ(PlaySmc100(kSmc100Identified + R"(
    < 1TS000132
    = note 'negative end of run'
    > 1TP
    < 1TP0
    > 1TS
    < 1TS000132
    = idle 0)"),
            "");
}

TEST(Smc100States, ADisabledMotorIsEnabledForAMove) {
  EXPECT_EQ(PlaySmc100(kSmc100Identified + R"(
    < 1TS00003C
    > 1TS
    < 1TS00003C
    = fault 'state 3C, DISABLE from READY'
    ! move 10
    > 1MM1
    > 1TE
    < 1TE@
    > 1TS
    < 1TS00003C
    + 25
    > 1TS
    < 1TS000034
    > 1PA10.00000
    > 1TE
    < 1TE@
    > 1TS
    < 1TS000033
    > 1TP
    < 1TP10
    > 1TS
    < 1TS000033
    = idle 10)"),
            "");
  EXPECT_EQ(PlaySmc100(kSmc100Identified + R"(
    < 1TS00003D
    > 1TS
    < 1TS00003D
    = fault 'DISABLE from MOVING'
    ! home
    > 1MM1
    > 1TE
    < 1TEJ
    > 1TBJ
    < 1TBJ Command not allowed in DISABLE state.
    > 1TS
    < 1TS00003D
    = fault 'MM1 is refused: J Command not allowed in DISABLE state.')"),
            "");
}

TEST(Smc100States, AResetAtRestIsToldAndAskedForAHoming) {
  EXPECT_EQ(PlaySmc100(kSmc100Ready + R"(
    + 25
    > 1TP
    < 1TP0
    > 1TS
    < 1TS00000A
    > 1TS
    < 1TS00000A
    = unhomed '0A, NOT REFERENCED from reset: the controller was reset, or lost its reference'
    + 25
    > 1TS
    < 1TS00000A
    = unhomed 'the controller was reset')"),
            "");
}

TEST(Smc100States, AHomingThatFailsIsTold) {
  EXPECT_EQ(PlaySmc100(kSmc100Identified + R"(
    < 1TS00000A
    > 1TS
    < 1TS00000A
    = unhomed
    ! home
    > 1OR
    > 1TE
    < 1TEE
    > 1TS
    < 1TS00001E
    + 25
    > 1TS
    < 1TS00400B
    > 1TS
    < 1TS00400B
    = unhomed 'the homing failed: 0B, NOT REFERENCED from HOMING (homing time-out)')"),
            "");
}

TEST(Smc100States, WhatIsMovedByHandIsAFault) {
  EXPECT_EQ(PlaySmc100(kSmc100Ready + R"(
    + 25
    > 1TP
    < 1TP0
    > 1TS
    < 1TS000046
    > 1TS
    < 1TS000046
    = fault 'state 46, JOGGING or TRACKING'
    + 25
    > 1TS
    < 1TS000036
    > 1TS
    < 1TS000036
    = fault
    # ready in a way of its own: TE says whether it moves from there
    ! move 10
    > 1PA10.00000
    > 1TE
    < 1TE@
    > 1TS
    < 1TS000028
    = moving)"),
            "");
}

}  // namespace
}  // namespace turnlight::rig::serial::smc100
