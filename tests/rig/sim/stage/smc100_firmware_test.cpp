// Proves that the simulated SMC100 talks as its manual says, written down here by hand: silent set
// commands, TE's letters, TS's states and error bits; that its position is where the table is,
// within a step; and what each fault of the table makes of it. Does not prove that the drivers get
// on with it.
#include "rig/sim/stage/smc100_firmware.h"

#include "tests/rig/sim/stage/firmware_bench.h"

namespace turnlight::rig::sim::stage {
namespace {

using ::testing::HasSubstr;

struct Smc100Bench : FirmwareBench {
  // One line and the 10 ms that it takes.
  std::string Line(const std::string& line) {
    const std::string said = Ask(line + "\r\n");
    return said + Wait(11);
  }
  std::string Lines(const std::vector<std::string>& lines) {
    std::string said;
    for (const std::string& line : lines) said += Line(line);
    return said;
  }
};

Smc100Bench Smc100(std::vector<FaultEntry> entries = {}, Smc100Config config = {}) {
  Smc100Bench bench{FirmwareBench::Of<Smc100Firmware>(config, RigidTable(TableFeedback::kEncoder),
                                                      std::move(entries))};
  bench.Wait(1100);
  return bench;
}

Smc100Bench HomedSmc100(std::vector<FaultEntry> entries = {}) {
  Smc100Bench bench = Smc100(std::move(entries));
  EXPECT_EQ(bench.Line("1OR"), "");
  bench.Wait(8000);
  EXPECT_EQ(bench.Line("1TS"), "1TS000032\r\n");
  return bench;
}

TEST(Smc100Firmware, HomesOnlyFromNotReferenced) {
  Smc100Bench bench = Smc100();
  EXPECT_EQ(bench.Line("1TS"), "1TS00000A\r\n");
  EXPECT_EQ(bench.Line("1PA10"), "");
  EXPECT_EQ(bench.Line("1TE"), "1TEH\r\n");
  EXPECT_EQ(bench.Line("1TE"), "1TE@\r\n");  // told once
  EXPECT_EQ(bench.Line("1OR"), "");
  EXPECT_EQ(bench.Line("1TS"), "1TS00001E\r\n");
  EXPECT_EQ(bench.Lines({"1OR", "1TE"}), "1TEE\r\n");
  EXPECT_EQ(bench.Lines({"1PA1", "1TE"}), "1TEL\r\n");
  bench.Wait(8000);
  EXPECT_EQ(bench.Line("1TS"), "1TS000032\r\n");
  EXPECT_EQ(bench.Line("1TP"), "1TP0\r\n");
  EXPECT_EQ(bench.Lines({"1OR", "1TE"}), "1TEK\r\n");
  EXPECT_EQ(bench.Line("1RS"), "");
  EXPECT_EQ(bench.Line("1TS"), "");  // boots
  bench.Wait(1000);
  EXPECT_EQ(bench.Line("1TS"), "1TS00000A\r\n");
}

TEST(Smc100Firmware, MovesInDegrees) {
  Smc100Bench bench = HomedSmc100();
  EXPECT_EQ(bench.Line("1PA60.25"), "");
  EXPECT_EQ(bench.Line("1TS"), "1TS000028\r\n");
  EXPECT_EQ(bench.Lines({"1PA0", "1TE"}), "1TEM\r\n");
  bench.Wait(1300);
  EXPECT_EQ(bench.Line("1ts"), "1TS000033\r\n");
  EXPECT_EQ(bench.Line("1TP"), "1TP60.25\r\n");
  EXPECT_EQ(bench.Line("1TH"), "1TH60.25\r\n");
  EXPECT_EQ(bench.True(), 60.25);
  EXPECT_EQ(bench.Line("1PR-0.123"), "");
  bench.Wait(200);
  EXPECT_EQ(bench.Line("1TP"), "1TP60.13\r\n");  // a hundredth of a degree is a step
  EXPECT_EQ(bench.Line("1PA?"), "1PA60.127\r\n");
}

TEST(Smc100Firmware, RefusesInSilence) {
  Smc100Bench bench = HomedSmc100();
  EXPECT_EQ(bench.Line("1PA361"), "");
  EXPECT_EQ(bench.Line("1TS"), "1TS000032\r\n");
  EXPECT_EQ(bench.Line("1TB"), "1TBG Displacement out of limits\r\n");
  EXPECT_EQ(bench.Line("1TE"), "1TEG\r\n");
  EXPECT_EQ(bench.Lines({"1XX1", "1TE"}), "1TEA\r\n");
  EXPECT_EQ(bench.Lines({"1PAx", "1TE"}), "1TEC\r\n");
  EXPECT_EQ(bench.Lines({"1VA61", "1TE"}), "1TEC\r\n");
  EXPECT_EQ(bench.Line("2TS"), "");
  EXPECT_EQ(bench.Line("1SL?"), "1SL-360\r\n");
  EXPECT_EQ(bench.Line("1SR?"), "1SR360\r\n");
  EXPECT_EQ(bench.Lines({"1SR90", "1TE"}), "1TE@\r\n");
  EXPECT_EQ(bench.Lines({"1PA91", "1TE"}), "1TEG\r\n");
  EXPECT_EQ(bench.Line("1VA?"), "1VA60\r\n");
  EXPECT_EQ(bench.Lines({"1VA30", "1VA?"}), "1VA30\r\n");
  EXPECT_EQ(bench.Line("1ID?"), "1IDURS100CC_54321\r\n");
  EXPECT_THAT(bench.Line("1VE"), HasSubstr("1VE SMC_CC"));
}

TEST(Smc100Firmware, StopsAndDisables) {
  Smc100Bench bench = HomedSmc100();
  bench.Line("1PA90");
  bench.Wait(700);
  EXPECT_EQ(bench.Line("ST"), "");
  EXPECT_EQ(bench.Line("1TS"), "1TS000028\r\n");
  bench.Wait(260);
  EXPECT_EQ(bench.Line("1TS"), "1TS000033\r\n");
  EXPECT_NEAR(bench.True(), 42.0, 1.5);
  EXPECT_EQ(bench.Line("1MM0"), "");
  EXPECT_EQ(bench.Line("1TS"), "1TS00003C\r\n");
  EXPECT_EQ(bench.Lines({"1PA0", "1TE"}), "1TEJ\r\n");
  EXPECT_EQ(bench.Lines({"1MM1", "1TS"}), "1TS000034\r\n");
}

TEST(Smc100Firmware, ErrorBitsTellWhatWentWrong) {
  const std::vector<std::pair<FaultKind, std::string>> cases = {
      {FaultKind::kStall, "1TS00203D\r\n"},
      {FaultKind::kAlarm, "1TS00083D\r\n"},
      {FaultKind::kLimit, "1TS00020F\r\n"},
      {FaultKind::kReset, "1TS00000A\r\n"}};
  for (const auto& [kind, status] : cases) {
    Smc100Bench bench = HomedSmc100({AtAngle(kind, 40.0)});
    bench.Line("1PA40");
    bench.Wait(2000);
    EXPECT_EQ(bench.Line("1TS"), status) << FaultWord(kind);
    EXPECT_EQ(bench.True(), 20.0);
    bench.Line("1RS");
    bench.Wait(1100);
    bench.Line("1OR");
    bench.Wait(8000);
    bench.Line("1PA40");
    bench.Wait(2000);
    EXPECT_EQ(bench.Lines({"1TS", "1TP"}), "1TS000033\r\n1TP40\r\n");
  }
}

TEST(Smc100Firmware, HomingThatFails) {
  Smc100Bench endless = Smc100({MakeFault(FaultKind::kNeverHomes)});
  EXPECT_EQ(endless.Lines({"1OT5", "1TE"}), "1TE@\r\n");
  endless.Line("1OR");
  endless.Wait(4900);
  EXPECT_EQ(endless.Line("1TS"), "1TS00001E\r\n");
  endless.Wait(200);
  EXPECT_EQ(endless.Line("1TS"), "1TS00400B\r\n");
  Smc100Bench stuck = Smc100({MakeFault(FaultKind::kStuckSwitch)});
  stuck.Line("1OR");
  stuck.Wait(9000);
  EXPECT_EQ(stuck.Line("1TS"), "1TS00020B\r\n");
}

TEST(Smc100Firmware, HoldsOffASenderThatDoesNotWait) {
  Smc100Bench bench = HomedSmc100();
  std::string flood;
  for (int i = 0; i < 40; ++i) flood += "1TS\r\n";
  EXPECT_EQ(bench.Ask(flood), "1TS000032\r\n\x13");
  const std::string said = bench.Wait(600);
  EXPECT_THAT(said, HasSubstr("\x11"));
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 39);
}

}  // namespace
}  // namespace turnlight::rig::sim::stage
