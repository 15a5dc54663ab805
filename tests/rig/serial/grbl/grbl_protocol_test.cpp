// Proves: the conversation of a move, a homing and a halt with GRBL 1.1 and grblHAL as their
// documents have it, wherever the bytes are cut; oks that are lost, doubled or late, reports that
// are swallowed or damaged, alarms and restarts never make an arrival. Transcripts are written by
// hand from the firmware's documents. Does not prove: anything of a port
// (serial_turntable_test.cpp).
#include "rig/serial/grbl/grbl_protocol.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/rig/serial/grbl/grbl_talk.h"

namespace turnlight::rig::serial::grbl {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

std::string Status(const std::string& state, double x) {
  return "<" + state + "|MPos:" + std::to_string(x).substr(0, std::to_string(x).size() - 3) +
         ",0.000,0.000|FS:0,0>\r\n";
}

TableMotion MotionOf(Talk& talk) {
  const auto report = talk.LastReport();
  return report ? report->motion : TableMotion::kMoving;
}

// Everything, in pieces of every length.
class GrblConversation : public testing::TestWithParam<std::size_t> {};

// From power-up to the first report.
void ExpectIdentified(Talk& talk) {
  EXPECT_EQ(talk.Heard(), "");
  talk.Passes(500);
  talk.Says(kBannerText);
  talk.Says("[MSG:'$H'|'$X' to unlock]\r\n");
  EXPECT_EQ(talk.Heard(), "\n");
  talk.Says("ok\r\n");
  EXPECT_EQ(talk.Heard(), "$I\n");
  talk.Says(kInfo);
  EXPECT_EQ(talk.Heard(), "$$\n");
  talk.Says(kSettings);
  EXPECT_EQ(talk.Heard(), "$N\n");
  talk.Says(kStartup);
  EXPECT_EQ(talk.Heard(), "$#\n");
  talk.Says(kOffsets);
  EXPECT_EQ(talk.Heard(), "?");
  talk.Says("<Alarm|MPos:0.000,0.000,0.000|FS:0,0|WCO:0.000,0.000,0.000>\r\n");
  ASSERT_TRUE(talk.identified);
  EXPECT_EQ(talk.identified->identity.model, "Grbl 1.1h.20190825");
  EXPECT_DOUBLE_EQ(*talk.identified->traits.max_speed_deg_s, 60.0);
  EXPECT_NEAR(talk.identified->traits.resolution_deg, 0.01125, 1e-5);
  EXPECT_FALSE(talk.identified->traits.min_deg);
  EXPECT_EQ(MotionOf(talk), TableMotion::kUnhomed);
}

TEST_P(GrblConversation, HomesMovesAndArrives) {
  Talk talk({}, GetParam());
  ExpectIdentified(talk);
  talk.protocol.Home();
  EXPECT_EQ(talk.Heard(), "$H\n");
  talk.Passes(5000);
  EXPECT_THAT(talk.Heard(), testing::MatchesRegex("\\?+"));
  EXPECT_EQ(MotionOf(talk), TableMotion::kMoving);
  talk.Says("ok\r\n");
  talk.Passes(1000);
  talk.Says("<Idle|MPos:-1.000,0.000,0.000|FS:0,0>\r\n");
  EXPECT_EQ(talk.LastReport()->motion, TableMotion::kIdle);
  talk.Heard();

  talk.protocol.MoveTo(120.0);
  EXPECT_EQ(talk.Heard(), "G21 G90 G94 G1 X120.000 F1200.0\n");
  talk.Says("ok\r\n");
  EXPECT_EQ(talk.Heard(), "G4 P0.01\n");
  talk.Passes(1050);
  EXPECT_EQ(talk.Heard(), "?");
  talk.Says("<Run|MPos:20.004,0.000,0.000|FS:1200,0|Ov:100,100,100>\r\n");
  EXPECT_EQ(MotionOf(talk), TableMotion::kMoving);
  talk.Says("ok\r\n");
  EXPECT_EQ(talk.Heard(), "?");
  EXPECT_EQ(MotionOf(talk), TableMotion::kMoving);
  talk.Says("<Idle|MPos:120.004,0.000,0.000|FS:0,0|Pn:PXYZ>\r\n");
  const auto arrived = talk.LastReport();
  ASSERT_TRUE(arrived);
  EXPECT_EQ(arrived->motion, TableMotion::kIdle);
  EXPECT_DOUBLE_EQ(arrived->position_deg, 120.004);
  EXPECT_THAT(talk.notes, IsEmpty());
  EXPECT_FALSE(talk.failed);
}

INSTANTIATE_TEST_SUITE_P(Pieces, GrblConversation, testing::Values(1, 2, 3, 5, 7, 1000));

// A talk with a move to 10 degrees under way, its line not yet answered.
Talk MovingTalk() {
  Talk talk;
  talk.Identifies();
  talk.protocol.MoveTo(10.0);
  talk.Heard();
  talk.LastReport();  // of before
  return talk;
}

TEST(GrblProtocol, AsksFiveTimesASecondAtMostAndLessInMotion) {
  Talk talk;
  talk.Identifies();
  int asked = 0;
  for (int i = 0; i < 200; ++i) {
    talk.Passes(10);
    if (talk.Heard() == "?") {
      ++asked;
      talk.Says(Status("Idle", 0.0));
    }
  }
  EXPECT_LE(asked, 10);
  EXPECT_GE(asked, 9);
}

TEST(GrblProtocol, AReportsAgeIsThatOfItsQuestion) {
  Talk talk;
  talk.Identifies();
  talk.Passes(200);
  ASSERT_EQ(talk.Heard(), "?");
  talk.Passes(150);
  talk.Says(Status("Idle", 0.0));
  EXPECT_EQ(talk.LastReport()->age, std::chrono::milliseconds(150));
  // Late: it may answer the first of the two questions.
  talk.Passes(200);
  ASSERT_EQ(talk.Heard(), "?");
  talk.Passes(750);
  ASSERT_EQ(talk.Heard(), "?");
  talk.Says(Status("Idle", 0.0));
  EXPECT_EQ(talk.LastReport()->age, std::chrono::milliseconds(750));
  // The second answer comes with no question open, and counts for nothing.
  talk.Says(Status("Idle", 0.0));
  EXPECT_FALSE(talk.LastReport());
}

TEST(GrblProtocol, AnOldIdleIsNoArrival) {
  Talk talk = MovingTalk();
  talk.Says("ok\r\n");
  talk.Says("ok\r\n");  // a duplicate, taken for the dwell's
  EXPECT_THAT(talk.Heard(), HasSubstr("?"));
  for (const double x : {0.0, 0.0, 0.0}) {
    talk.Says(Status("Idle", x));
    EXPECT_EQ(MotionOf(talk), TableMotion::kMoving);
    talk.Passes(200);
  }
  talk.Says(Status("Run", 5.0));
  EXPECT_EQ(MotionOf(talk), TableMotion::kMoving);
  talk.Passes(200);
  talk.Says(Status("Idle", 10.0));
  EXPECT_EQ(talk.LastReport()->motion, TableMotion::kIdle);
}

TEST(GrblProtocol, ALostOkIsMadeUpForByTheReports) {
  Talk talk = MovingTalk();
  talk.Passes(1000);  // the ok of the move is lost
  EXPECT_EQ(talk.Heard(), "?");
  talk.Says(Status("Run", 3.0));
  EXPECT_EQ(talk.Heard(), "G4 P0.01\n");
  for (int i = 0; i < 6; ++i) {  // and that of the dwell too
    talk.Passes(1000);
    talk.Says(Status("Idle", 10.0));
  }
  EXPECT_EQ(talk.LastReport()->motion, TableMotion::kIdle);
  EXPECT_EQ(talk.notes.size(), 2u);
  EXPECT_FALSE(talk.failed);
}

TEST(GrblProtocol, AMoveThatGotLostIsSentAgainOnce) {
  Talk talk = MovingTalk();
  std::string heard;
  for (int i = 0; i < 12; ++i) {
    talk.Passes(1000);
    heard += talk.Heard();
    talk.Says(Status("Idle", 0.0));
  }
  const std::string move = "G1 X10.000";
  EXPECT_NE(heard.find(move), std::string::npos);
  EXPECT_EQ(heard.find(move), heard.rfind(move));
  const auto report = talk.LastReport();
  ASSERT_TRUE(report);
  EXPECT_EQ(report->motion, TableMotion::kFault);
  EXPECT_THAT(report->fault, HasSubstr("stands at 0.000 deg and does not go to 10.000"));
}

TEST(GrblProtocol, ALateOkCompletesNothing) {
  Talk talk;
  talk.Identifies();
  talk.LastReport();
  talk.Says("ok\r\nok\r\n");  // of lines long ago
  talk.protocol.MoveTo(10.0);
  EXPECT_THAT(talk.Heard(), HasSubstr("X10.000"));
  EXPECT_EQ(MotionOf(talk), TableMotion::kMoving);
}

TEST(GrblProtocol, DamagedReportsAreNoReports) {
  Talk talk = MovingTalk();
  talk.Says("ok\r\n");
  talk.Says("ok\r\n");
  talk.Heard();
  for (const char* damaged :
       {"<Idle|MPos:10.0x0,0.000,0.000>\r\n", "<Idle|MPos:10.000,0.000,0.000\r\n",
        "Idle|MPos:10.000,0.000,0.000>\r\n", "<Idel|MPos:10.000,0.000,0.000>\r\n",
        "<Idle|MPos:>\r\n", "<Idle>\r\n", "<Idle|MPos:nan,0,0>\r\n", "<Idle|MPos:1e999,0,0>\r\n",
        "<Idle|MPos:10.000,0.000,0.000|WPos:0.000,0.000,0.000>\r\n"}) {
    talk.Says(damaged);
    EXPECT_EQ(MotionOf(talk), TableMotion::kMoving) << damaged;
  }
  EXPECT_FALSE(talk.failed);
  talk.Says(Status("Idle", 10.0));
  EXPECT_EQ(talk.LastReport()->motion, TableMotion::kIdle);
}

TEST(GrblProtocol, TooManyBadLinesInARowAreABadLink) {
  Talk talk;
  talk.Identifies();
  for (int i = 0; i < 9; ++i) talk.Says("\x81\x7f~~\n");
  EXPECT_FALSE(talk.failed);
  talk.Says("ok\r\n");
  for (int i = 0; i < 10; ++i) talk.Says("ko\r\n");
  ASSERT_TRUE(talk.failed);
  EXPECT_THAT(talk.failed->text, HasSubstr("baud rate"));
  EXPECT_FALSE(talk.failed->for_good);
}

TEST(GrblProtocol, SilenceEndsTheConversation) {
  Talk talk;
  talk.Identifies();
  talk.Passes(3000);
  ASSERT_TRUE(talk.failed);
  EXPECT_THAT(talk.failed->text, HasSubstr("does not answer"));
}

TEST(GrblProtocol, AHaltHoldsThenResetsAndKeepsThePosition) {
  Talk talk = MovingTalk();
  talk.Says("ok\r\n");
  talk.Heard();
  talk.protocol.Halt();
  EXPECT_EQ(talk.Heard(), "!?");
  talk.Says("<Hold:1|MPos:4.500,0.000,0.000|FS:300,0>\r\n");
  talk.Passes(100);
  EXPECT_EQ(talk.Heard(), "?");
  talk.Says("<Hold:0|MPos:5.006,0.000,0.000|FS:0,0>\r\n");
  EXPECT_EQ(talk.Heard(), "\x18");
  talk.Says(kBannerText);
  EXPECT_EQ(talk.Heard(), "?");
  talk.Says("<Idle|MPos:5.006,0.000,0.000|FS:0,0|WCO:0.000,0.000,0.000>\r\n");
  const auto report = talk.LastReport();
  EXPECT_EQ(report->motion, TableMotion::kIdle);
  EXPECT_DOUBLE_EQ(report->position_deg, 5.006);
}

TEST(GrblProtocol, AHaltThatDoesNotComeToRestLosesThePosition) {
  Talk talk = MovingTalk();
  talk.Says("ok\r\n");
  talk.protocol.Halt();
  for (int i = 0; i < 31; ++i) {
    talk.Says("<Hold:1|MPos:4.500,0.000,0.000|FS:300,0>\r\n");
    talk.Passes(100);
  }
  EXPECT_THAT(talk.Heard(), HasSubstr("\x18"));
  talk.Says("ALARM:3\r\n");
  talk.Says(kBannerText);
  talk.Says("<Alarm|MPos:5.006,0.000,0.000|FS:0,0>\r\n");
  EXPECT_EQ(MotionOf(talk), TableMotion::kUnhomed);
}

TEST(GrblProtocol, AHomingIsStoppedByAReset) {
  Talk talk;
  talk.Identifies();
  talk.protocol.Home();
  talk.Heard();
  talk.protocol.Halt();
  EXPECT_EQ(talk.Heard(), "\x18");
  talk.Says("ALARM:6\r\n");
  talk.Says(kBannerText);
  talk.Says("<Alarm|MPos:0.000,0.000,0.000|FS:0,0>\r\n");
  const auto report = talk.LastReport();
  EXPECT_EQ(report->motion, TableMotion::kUnhomed);
  EXPECT_THAT(report->fault, HasSubstr("ALARM:6 (homing was reset)"));
}

TEST(GrblProtocol, AHardLimitNeedsAResetBeforeHoming) {
  Talk talk = MovingTalk();
  talk.Says("ok\r\n");
  talk.Says("ALARM:1\r\n[MSG:Reset to continue]\r\n");
  const auto report = talk.LastReport();
  EXPECT_EQ(report->motion, TableMotion::kUnhomed);
  EXPECT_THAT(report->fault, HasSubstr("ALARM:1 (hard limit, position lost)"));
  talk.Heard();
  talk.protocol.Home();
  EXPECT_EQ(talk.Heard(), "\x18");
  talk.Says(std::string(kBannerText) + "[MSG:'$H'|'$X' to unlock]\r\n");
  EXPECT_EQ(talk.Heard(), "$H\n");
  talk.Says("ok\r\n");
  talk.Passes(1000);
  talk.Says(Status("Idle", -1.0));
  EXPECT_EQ(talk.LastReport()->motion, TableMotion::kIdle);
}

// The firmware forgets a reset that comes while it tells a critical alarm, for half a second.
TEST(GrblProtocol, AResetThatIsForgottenIsAskedForAgain) {
  Talk talk = MovingTalk();
  talk.Says("ALARM:1\r\n");
  talk.Heard();
  talk.protocol.Home();
  EXPECT_EQ(talk.Heard(), "\x18");
  talk.Passes(800);
  EXPECT_EQ(talk.Heard(), "\x18");
  talk.Says(kBannerText);
  EXPECT_EQ(talk.Heard(), "$H\n");
}

TEST(GrblProtocol, AHomingThatFindsNoSwitchIsAFault) {
  Talk talk;
  talk.Identifies();
  talk.protocol.Home();
  talk.Says("ALARM:9\r\n");
  talk.Says(kBannerText);
  talk.Says("[MSG:'$H'|'$X' to unlock]\r\n");
  talk.Passes(300);
  talk.Says("<Alarm|MPos:0.000,0.000,0.000|FS:0,0>\r\n");
  const auto report = talk.LastReport();
  EXPECT_EQ(report->motion, TableMotion::kUnhomed);
  EXPECT_THAT(report->fault, HasSubstr("no switch found"));
}

TEST(GrblProtocol, ARestartInAMoveLosesThePosition) {
  Talk talk = MovingTalk();
  talk.Says("ok\r\n");
  talk.Says(kBannerText);
  talk.Says("<Idle|MPos:0.000,0.000,0.000|FS:0,0>\r\n");
  const auto report = talk.LastReport();
  EXPECT_EQ(report->motion, TableMotion::kUnhomed);
  EXPECT_THAT(report->fault, HasSubstr("restarted by itself: \"Grbl 1.1h\""));
  // Also one that is in the middle of nothing.
  Talk standing;
  standing.Identifies();
  standing.Says(kBannerText);
  standing.Says(Status("Idle", 0.0));
  EXPECT_EQ(MotionOf(standing), TableMotion::kUnhomed);
}

TEST(GrblProtocol, ARefusedMoveIsAFaultInTheVendorsWords) {
  Talk talk = MovingTalk();
  talk.Says("error:9\r\n");
  talk.Passes(250);
  talk.Says("<Alarm|MPos:0.000,0.000,0.000|FS:0,0>\r\n");
  EXPECT_THAT(talk.LastReport()->fault, HasSubstr("error:9 (locked out"));
  Talk other = MovingTalk();
  other.Says("error:33\r\n");
  other.Passes(250);
  other.Says(Status("Idle", 0.0));
  const auto report = other.LastReport();
  EXPECT_EQ(report->motion, TableMotion::kFault);
  EXPECT_THAT(report->fault, HasSubstr("error:33 (invalid target)"));
}

TEST(GrblProtocol, ADoorOrAHoldStopsAMove) {
  for (const char* state : {"Door:1", "Hold:0", "Sleep"}) {
    Talk talk = MovingTalk();
    talk.Says("ok\r\n");
    talk.Passes(1000);
    talk.Says(Status(state, 5.0));
    const auto report = talk.LastReport();
    ASSERT_TRUE(report) << state;
    EXPECT_EQ(report->motion, TableMotion::kFault) << state;
    EXPECT_THAT(report->fault, HasSubstr(state));
  }
}

TEST(GrblProtocol, AMachineThatReportsWorkPositions) {
  Talk talk;
  talk.Identifies(kSettings, "<Idle|WPos:10.000,0.000,0.000|FS:0,0>\r\n");
  EXPECT_FALSE(talk.LastReport());  // its offset has not been told
  talk.Passes(200);
  talk.Says("<Idle|WPos:10.000,0.000,0.000|FS:0,0|WCO:-4.000,0.000,0.000>\r\n");
  EXPECT_DOUBLE_EQ(talk.LastReport()->position_deg, 6.0);
  talk.Heard();
  talk.protocol.MoveTo(20.0);
  EXPECT_EQ(talk.Heard(), "G21 G90 G94 G53 G1 X20.000 F1200.0\n");
}

// Found by the fuzzer: the end of a homing is no arrival of the move that waits for it.
TEST(GrblProtocol, AMoveDuringAHomingFollowsIt) {
  Talk talk;
  talk.Identifies();
  talk.protocol.Home();
  talk.protocol.MoveTo(10.0);
  talk.Heard();
  talk.LastReport();
  talk.Says("ok\r\n");
  talk.Says(Status("Idle", -1.0));
  EXPECT_EQ(MotionOf(talk), TableMotion::kMoving);
  EXPECT_THAT(talk.Heard(), HasSubstr("X10.000"));
}

TEST(GrblProtocol, AMoveBehindTheLampsLineWaits) {
  GrblOptions options;
  options.lamp_power = 0.5;
  Talk talk(options);
  talk.Identifies(std::string(kSettings), "<Idle|MPos:0.000,0.000,0.000|FS:0,0>\r\n");
  talk.protocol.MoveTo(10.0);
  EXPECT_EQ(talk.Heard(), "");
  EXPECT_EQ(talk.LastReport()->motion, TableMotion::kIdle);  // of before
  talk.Says("ok\r\n");                                       // the lamp is on
  EXPECT_THAT(talk.Heard(), HasSubstr("X10.000"));
  talk.protocol.Leave();
  EXPECT_EQ(talk.Heard(), "M5\n");
}

}  // namespace
}  // namespace turnlight::rig::serial::grbl
