// Proves that the simulated GRBL talks as the 1.1 documents of grbl say, written down here by hand:
// banners, `ok` on acceptance, reports, alarms, locks, buffers; that what it reports is where the
// table is, within a step; and what each fault of the table makes of it. Does not prove that the
// drivers get on with it, nor that every line of the documents is there (see its header).
#include "rig/sim/stage/grbl_firmware.h"

#include "tests/rig/sim/stage/firmware_bench.h"

namespace turnlight::rig::sim::stage {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr const char* kBanner = "\r\nGrbl 1.1h ['$' for help]\r\n";
constexpr const char* kLocked = "[MSG:'$H'|'$X' to unlock]\r\n";

FirmwareBench Grbl(GrblConfig config = {}, std::vector<FaultEntry> entries = {}) {
  return FirmwareBench::Of<GrblFirmware>(config, RigidTable(TableFeedback::kOpenLoop),
                                         std::move(entries));
}

// Booted and homed.
FirmwareBench HomedGrbl(std::vector<FaultEntry> entries = {}, GrblConfig config = {}) {
  config.settings[22] = 1;
  FirmwareBench bench = Grbl(std::move(config), std::move(entries));
  bench.Wait(600);
  EXPECT_EQ(bench.Ask("$H\n"), "");
  EXPECT_EQ(bench.Wait(8000), "ok\r\n");
  return bench;
}

TEST(GrblFirmware, IsSilentAndDeafForHalfASecondThenShowsItsBanner) {
  FirmwareBench bench = Grbl();
  EXPECT_EQ(bench.Ask("?\n$I\n"), "");
  EXPECT_EQ(bench.Wait(490), "");
  EXPECT_EQ(bench.Wait(20), kBanner);
  EXPECT_EQ(bench.Ask("?"), "<Idle|MPos:0.000,0.000,0.000|FS:0,0|WCO:0.000,0.000,0.000>\r\n");
  EXPECT_EQ(bench.Ask("?"), "<Idle|MPos:0.000,0.000,0.000|FS:0,0|Ov:100,100,100>\r\n");
  EXPECT_EQ(bench.Ask("?"), "<Idle|MPos:0.000,0.000,0.000|FS:0,0>\r\n");
  EXPECT_EQ(bench.Ask("???"), "<Idle|MPos:0.000,0.000,0.000|FS:0,0>\r\n");  // one for all
}

TEST(GrblFirmware, IsLockedAtPowerUpIfHomingIsOn) {
  GrblConfig config;
  config.settings = {{22, 1}};
  FirmwareBench bench = Grbl(config);
  EXPECT_EQ(bench.Wait(600), std::string(kBanner) + kLocked);
  EXPECT_EQ(bench.Ask("G0X1\n"), "error:9\r\n");
  EXPECT_THAT(bench.Ask("?"), StartsWith("<Alarm|MPos:0.000,"));
  EXPECT_EQ(bench.Ask("$X\n"), "[MSG:Caution: Unlocked]\r\nok\r\n");
  EXPECT_EQ(bench.Ask("$X\n"), "ok\r\n");
  EXPECT_EQ(bench.Ask("G0X1\n"), "ok\r\n");
}

TEST(GrblFirmware, TellsWhoItIsAndHowItIsSet) {
  GrblConfig config;
  config.build_info = "table 7";
  config.startup = {"G21", ""};
  FirmwareBench bench = Grbl(config);
  EXPECT_EQ(bench.Wait(600), std::string(kBanner) + ">G21:ok\r\n");
  EXPECT_EQ(bench.Ask("$I\r\n"),
            "[VER:1.1h.20190830:table 7]\r\n[OPT:VZ,15,128]\r\nok\r\nok\r\n");  // CR, then LF
  EXPECT_EQ(bench.Ask("$N\n"), "$N0=G21\r\n$N1=\r\nok\r\n");
  EXPECT_EQ(bench.Ask("$G\n"), "[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]\r\nok\r\n");
  EXPECT_THAT(bench.Ask("$#\n"), StartsWith("[G54:0.000,0.000,0.000]\r\n[G55:"));
  const std::string settings = bench.Ask("$$\n");
  EXPECT_THAT(settings, StartsWith("$0=10\r\n$1=255\r\n"));
  EXPECT_THAT(settings, HasSubstr("$11=0.010\r\n"));
  EXPECT_THAT(settings, HasSubstr("$22=0\r\n"));
  EXPECT_THAT(settings, HasSubstr("$100=100.000\r\n$101=250.000\r\n"));
  EXPECT_THAT(settings, HasSubstr("$110=3600.000\r\n"));
  EXPECT_THAT(settings, EndsWith("$132=200.000\r\nok\r\n"));
  EXPECT_EQ(bench.Ask("$H\n"), "error:5\r\n");
  EXPECT_EQ(bench.Ask("$20=1\n"), "error:10\r\n");
  EXPECT_EQ(bench.Ask("$22=1\n$20=1\n"), "ok\r\nok\r\n");
  EXPECT_EQ(bench.Ask("$77=1\n"), "error:3\r\n");
  EXPECT_EQ(bench.Ask("$J\n"), "error:2\r\n");
}

TEST(GrblFirmware, AnswersOkOnAcceptanceAndWaitsInADwell) {
  FirmwareBench bench = HomedGrbl();
  EXPECT_EQ(bench.Ask("G21 G90 G94\n"), "ok\r\n");
  // 60 deg at 60 deg/s with 240 deg/s2: 1.25 s.
  EXPECT_EQ(bench.Ask("g1 x60 f3600 (turn) ; now\n"), "ok\r\n");
  EXPECT_EQ(bench.Ask("G4 P0.1\n"), "");
  EXPECT_EQ(bench.Wait(600), "");
  EXPECT_THAT(bench.Ask("?"), HasSubstr("<Run|MPos:2"));
  EXPECT_EQ(bench.Ask("$I\n"), "");  // stays in the buffer until the dwell is over
  EXPECT_EQ(bench.Wait(700), "");
  EXPECT_THAT(bench.Wait(100), StartsWith("ok\r\n[VER:"));
  EXPECT_THAT(bench.Ask("?"), StartsWith("<Idle|MPos:60.000,0.000,0.000|FS:0,0"));
  EXPECT_EQ(bench.True(), 60.0);
}

TEST(GrblFirmware, ObeysTheFeedAndReportsItsSpeed) {
  FirmwareBench bench = HomedGrbl();
  EXPECT_EQ(bench.Ask("G1X30F600\n"), "ok\r\n");
  bench.Wait(1500);
  EXPECT_NEAR(bench.True(), 14.8, 0.1);  // 10 deg/s, less half of the ramp
  EXPECT_THAT(bench.Ask("?"), HasSubstr("|FS:600,0"));
  bench.Wait(2000);
  EXPECT_EQ(bench.True(), 30.0);
}

TEST(GrblFirmware, HonoursTheMaskTheInchesAndTheSpindle) {
  GrblConfig config;
  config.settings = {{10, 2}, {13, 1}};
  FirmwareBench bench = HomedGrbl({}, config);
  EXPECT_EQ(bench.Ask("M3S500\nG0X25.4\n"), "ok\r\nok\r\n");
  bench.Wait(2000);
  const std::string report = bench.Ask("?");
  EXPECT_THAT(report, StartsWith("<Idle|WPos:1.0000,0.0000,0.0000|Bf:15,128|FS:0.0,500|WCO:"));
  EXPECT_THAT(bench.Ask("?"), HasSubstr("|Ov:100,100,100|A:S>"));
  bench.Ask("M5\n");
  EXPECT_THAT(bench.Ask("?"), HasSubstr("FS:0.0,0"));
}

TEST(GrblFirmware, ReportsWholeStepsInThreeDecimals) {
  MockTurntableConfig table = RigidTable(TableFeedback::kOpenLoop);
  table.steps_per_deg = 8.888;
  FirmwareBench bench = FirmwareBench::Of<GrblFirmware>(GrblConfig{}, table);
  bench.Wait(600);
  bench.Ask("G0X10\n");
  bench.Wait(2000);
  EXPECT_THAT(bench.Ask("?"), HasSubstr("MPos:10.014,"));  // 89 steps
  EXPECT_EQ(bench.table->Motor(bench.now).counted_deg, 89.0 / 8.888);
}

TEST(GrblFirmware, HoldsResumesAndKeepsThePositionOverAResetInAHold) {
  FirmwareBench bench = HomedGrbl();
  bench.Ask("G1X90F3600\n");
  bench.Wait(700);
  EXPECT_EQ(bench.Ask("!"), "");
  EXPECT_THAT(bench.Ask("?"), StartsWith("<Hold:1|"));
  bench.Wait(260);
  EXPECT_THAT(bench.Ask("?"), StartsWith("<Hold:0|"));
  const double held = bench.True();
  EXPECT_NEAR(held, 42.0, 1.0);        // 34.5, and 7.5 to come to rest
  EXPECT_EQ(bench.Ask("G0X1\n"), "");  // nothing is read in a hold
  bench.Wait(100);
  EXPECT_EQ(bench.True(), held);
  EXPECT_EQ(bench.Ask("~"), "ok\r\n");
  bench.Wait(300);
  EXPECT_GT(bench.True(), held);
  bench.Ask("!");
  bench.Wait(400);
  EXPECT_EQ(bench.Ask("\x18"), kBanner);
  EXPECT_THAT(bench.Ask("?"), StartsWith("<Idle|"));
  EXPECT_NEAR(bench.table->Motor(bench.now).counted_deg, bench.True(), 1e-9);
}

TEST(GrblFirmware, AResetInMotionIsAlarmThree) {
  FirmwareBench bench = HomedGrbl();
  bench.Ask("G1X90F3600\nG4P0\n");
  bench.Wait(500);
  EXPECT_EQ(bench.Ask("\x18"), "ALARM:3\r\n");
  EXPECT_EQ(bench.Wait(490), "");
  // The dwell's line is answered on the way out.
  EXPECT_EQ(bench.Wait(20), std::string("ok\r\n") + kBanner + kLocked);
  EXPECT_EQ(bench.Ask("G0X1\n"), "error:9\r\n");
}

TEST(GrblFirmware, ASoftLimitLocksEverythingUntilAReset) {
  GrblConfig config;
  config.settings = {{20, 1}, {23, 1}, {130, 250}};  // 0 to 250
  FirmwareBench bench = HomedGrbl({}, config);
  EXPECT_EQ(bench.Ask("G0X250\n"), "ok\r\n");
  bench.Wait(6000);
  EXPECT_EQ(bench.Ask("G0X250.01\n"), "ALARM:2\r\n");
  EXPECT_EQ(bench.Ask("\x18"), "");  // too early: it is forgotten
  EXPECT_EQ(bench.Wait(510), "[MSG:Reset to continue]\r\n");
  EXPECT_EQ(bench.Ask("?\n$X\n"), "");
  EXPECT_EQ(bench.Wait(100), "");
  EXPECT_EQ(bench.Ask("\x18"), std::string("ok\r\n") + kBanner + kLocked);
  EXPECT_EQ(bench.Ask("$X\n"), "[MSG:Caution: Unlocked]\r\nok\r\n");
  EXPECT_THAT(bench.Ask("?"), HasSubstr("MPos:250.000,"));
  EXPECT_EQ(bench.True(), 250.0);
}

TEST(GrblFirmware, AnswersNoQuestionWhileHoming) {
  GrblConfig config;
  config.settings = {{22, 1}};
  FirmwareBench bench = Grbl(config);
  bench.Wait(600);
  EXPECT_EQ(bench.Ask("$H\n"), "");
  EXPECT_EQ(bench.Wait(500), "");
  EXPECT_EQ(bench.Ask("?"), "");
  EXPECT_THAT(bench.Wait(8000), ::testing::MatchesRegex("<Home.*>\r\nok\r\n"));
  EXPECT_EQ(bench.True(), 0.0);
  EXPECT_THAT(bench.Ask("?"), StartsWith("<Idle|MPos:0.000,"));
}

TEST(GrblFirmware, AResetWhileHomingIsAlarmSix) {
  GrblConfig config;
  config.settings = {{22, 1}};
  FirmwareBench bench = Grbl(config);
  bench.Wait(600);
  bench.Ask("$H\n");
  bench.Wait(500);
  EXPECT_EQ(bench.Ask("\x18"), "ALARM:6\r\n");
  EXPECT_EQ(bench.Wait(510), std::string("ok\r\n") + kBanner + kLocked);
}

TEST(GrblFirmware, LinesAndBuffersAreBounded) {
  FirmwareBench bench = HomedGrbl();
  EXPECT_EQ(bench.Ask(std::string(79, ' ') + "G4P0" + std::string(76, '0') + "\n"), "error:11\r\n");
  EXPECT_EQ(bench.Ask("G4P0" + std::string(75, '0') + "\n"), "ok\r\n");
  EXPECT_EQ(bench.Ask("\n"), "ok\r\n");
  // One moves, fifteen slots in all, the seventeenth line waits.
  std::string lines;
  for (int i = 1; i <= 16; ++i) lines += "G0X" + std::to_string(i) + "\n";
  std::string fifteen;
  for (int i = 0; i < 15; ++i) fifteen += "ok\r\n";
  EXPECT_EQ(bench.Ask(lines), fifteen);
  EXPECT_EQ(bench.Wait(300), "ok\r\n");
  // More than the 128 bytes that there are is lost.
  bench.Ask("G4P1\n");
  bench.Ask(std::string(200, '\n'));
  std::string said = bench.Wait(9000);
  EXPECT_EQ(said.size() / 4, 129u);
  EXPECT_EQ(bench.True(), 16.0);
}

TEST(GrblFirmware, AHardLimitAndAnAlarmInAMove) {
  for (const FaultKind kind : {FaultKind::kAlarm, FaultKind::kLimit}) {
    FirmwareBench bench = HomedGrbl({AtAngle(kind, 40.0)});
    bench.Ask("G0X40\n");
    EXPECT_EQ(bench.Wait(800), "ALARM:1\r\n");
    EXPECT_EQ(bench.True(), 20.0);
    EXPECT_EQ(bench.Wait(300), "[MSG:Reset to continue]\r\n");
    EXPECT_EQ(bench.Ask("?"), "");
    EXPECT_EQ(bench.Ask("\x18"), std::string(kBanner) + kLocked);
    EXPECT_THAT(bench.Ask("?"), StartsWith("<Alarm|"));
    bench.Ask("$H\n");
    EXPECT_THAT(bench.Wait(8000), EndsWith("ok\r\n"));
    bench.Ask("G0X40\n");
    bench.Wait(2000);
    EXPECT_EQ(bench.True(), 40.0);
  }
}

TEST(GrblFirmware, ARestartInAMoveLosesThePosition) {
  FirmwareBench bench = HomedGrbl({AtAngle(FaultKind::kReset, 40.0)});
  bench.Ask("G0X40\n");
  EXPECT_EQ(bench.Wait(1200), std::string(kBanner) + kLocked);
  EXPECT_THAT(bench.Ask("?"), StartsWith("<Alarm|MPos:0.000,"));
  EXPECT_EQ(bench.True(), 20.0);
}

TEST(GrblFirmware, HomingThatFails) {
  GrblConfig config;
  config.settings = {{22, 1}};
  FirmwareBench endless = Grbl(config, {MakeFault(FaultKind::kNeverHomes)});
  endless.Wait(600);
  endless.Ask("$H\n");
  EXPECT_EQ(endless.Wait(8900), "");  // 1.5 x 360 deg at 60 deg/s
  EXPECT_EQ(endless.Wait(200), "ALARM:9\r\n");
  EXPECT_EQ(endless.Wait(500), std::string("ok\r\n") + kBanner + kLocked);
  FirmwareBench stuck = Grbl(config, {MakeFault(FaultKind::kStuckSwitch)});
  stuck.Wait(600);
  stuck.Ask("$H\n");
  EXPECT_EQ(stuck.Wait(9000), std::string("ALARM:8\r\nok\r\n") + kBanner + kLocked);
  EXPECT_EQ(stuck.Ask("$H\n"), "ok\r\n");  // it stands there already
}

TEST(GrblFirmware, LostStepsAreInvisible) {
  FirmwareBench bench =
      HomedGrbl({AtAngle(FaultKind::kLostSteps, 40.0), AtAngle(FaultKind::kDisplaced, 50.0)});
  bench.Ask("G0X40\n");
  bench.Wait(2000);
  EXPECT_THAT(bench.Ask("?"), HasSubstr("MPos:40.000,"));
  EXPECT_EQ(bench.True(), 39.0);
  bench.Ask("G0X50\n");
  bench.Wait(2000);
  EXPECT_THAT(bench.Ask("?"), HasSubstr("MPos:50.000,"));
  EXPECT_EQ(bench.True(), 49.5);
}

TEST(GrblFirmware, WithAnAxisAItIsAGrblHal) {
  GrblConfig config;
  config.axis = 'A';
  FirmwareBench bench = Grbl(config);
  EXPECT_EQ(bench.Wait(600), "\r\nGrblHAL 1.1f ['$' or '$HELP' for help]\r\n");
  EXPECT_THAT(bench.Ask("$I\n"), HasSubstr("[FIRMWARE:grblHAL]\r\n"));
  EXPECT_THAT(bench.Ask("$$\n"), HasSubstr("$103=100.000\r\n"));
  EXPECT_EQ(bench.Ask("G0A12\n"), "ok\r\n");
  bench.Wait(2000);
  EXPECT_THAT(bench.Ask("?"), StartsWith("<Idle|MPos:0.000,0.000,0.000,12.000|"));
}

}  // namespace
}  // namespace turnlight::rig::sim::stage
