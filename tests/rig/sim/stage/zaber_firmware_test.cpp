// Proves that the simulated Zaber talks as the ASCII protocol's documents say, written down here by
// hand: replies, checksums, ids, flags, rejections, alerts; that its position is where the table
// is, within a microstep; and what each fault of the table makes of it. Does not prove that the
// drivers get on with it.
#include "rig/sim/stage/zaber_firmware.h"

#include "tests/rig/sim/stage/firmware_bench.h"

namespace turnlight::rig::sim::stage {
namespace {

using ::testing::EndsWith;
using ::testing::StartsWith;

FirmwareBench Zaber(std::vector<FaultEntry> entries = {}, ZaberConfig config = {}) {
  FirmwareBench bench = FirmwareBench::Of<ZaberFirmware>(
      config, RigidTable(TableFeedback::kEncoder), std::move(entries));
  bench.Wait(300);
  return bench;
}

FirmwareBench HomedZaber(std::vector<FaultEntry> entries = {}) {
  FirmwareBench bench = Zaber(std::move(entries));
  EXPECT_EQ(bench.Ask("/1 1 home\n"), "@01 1 OK BUSY WR 0\r\n");
  bench.Wait(8000);
  EXPECT_EQ(bench.Ask("/1 1\n"), "@01 1 OK IDLE -- 0\r\n");
  return bench;
}

TEST(ZaberFirmware, IsNotReferencedUntilItIsHomed) {
  FirmwareBench bench = Zaber();
  EXPECT_EQ(bench.Ask("/\n"), "@01 0 OK IDLE WR 0\r\n");
  EXPECT_EQ(bench.Ask("/1 1 warnings\n"), "@01 1 OK IDLE WR 02 WR WH\r\n");
  EXPECT_EQ(bench.Ask("/1 1 warnings clear\n"), "@01 1 OK IDLE WR 02 WR WH\r\n");
  EXPECT_EQ(bench.Ask("/1 1 move abs 100\n"), "@01 1 RJ IDLE WR BADDATA\r\n");
  EXPECT_EQ(bench.Ask("/1 1 home\r\n"), "@01 1 OK BUSY WR 0\r\n");
  EXPECT_EQ(bench.Wait(8000), "");
  EXPECT_EQ(bench.Ask("/1 1 get pos\n"), "@01 1 OK IDLE -- 0\r\n");
  EXPECT_EQ(bench.True(), 0.0);
}

TEST(ZaberFirmware, MovesInMicrosteps) {
  FirmwareBench bench = HomedZaber();
  EXPECT_EQ(bench.Ask("/1 1 move abs 6000\n"), "@01 1 OK BUSY -- 0\r\n");
  bench.Wait(1240);
  EXPECT_THAT(bench.Ask("/1 1\n"), StartsWith("@01 1 OK BUSY"));
  bench.Wait(20);
  EXPECT_EQ(bench.Ask("/1 1 get pos\n"), "@01 1 OK IDLE -- 6000\r\n");
  EXPECT_EQ(bench.True(), 60.0);
  EXPECT_EQ(bench.Ask("/1 1 move rel -1\n"), "@01 1 OK BUSY -- 0\r\n");
  bench.Wait(100);
  EXPECT_EQ(bench.Ask("/1 get encoder.pos\n"), "@01 0 OK IDLE -- 5999\r\n");
  EXPECT_EQ(bench.True(), 59.99);
}

TEST(ZaberFirmware, ChecksumsIdsAndAddresses) {
  FirmwareBench bench = HomedZaber();
  EXPECT_EQ(ZaberChecksum("1 cont 1 gggggggggg"), "84");
  EXPECT_EQ(bench.Ask("/1 1 7 get pos:" + ZaberChecksum("1 1 7 get pos") + "\n"),
            "@01 1 07 OK IDLE -- 0\r\n");
  EXPECT_EQ(bench.Ask("/1 1 7 get pos:00\n"), "");  // a wrong one is passed over
  EXPECT_EQ(bench.Ask("/2 1 get pos\n"), "");
  EXPECT_EQ(bench.Ask("/1 2 get pos\n"), "@01 2 RJ IDLE -- BADAXIS\r\n");
  EXPECT_EQ(bench.Ask("/1 0 set comm.checksum 1\n"),
            "@01 0 OK IDLE -- 0:" + ZaberChecksum("01 0 OK IDLE -- 0") + "\r\n");
  EXPECT_EQ(bench.Ask("noise/1 1 get pos\n"),
            "@01 1 OK IDLE -- 0:" + ZaberChecksum("01 1 OK IDLE -- 0") + "\r\n");
}

TEST(ZaberFirmware, TellsWhoItIsAndHowItIsSet) {
  FirmwareBench bench = HomedZaber();
  EXPECT_EQ(bench.Ask("/1 get device.id\n"), "@01 0 OK IDLE -- 50926\r\n");
  EXPECT_EQ(bench.Ask("/1 get version\n"), "@01 0 OK IDLE -- 7.35\r\n");
  EXPECT_EQ(bench.Ask("/1 get system.serial\n"), "@01 0 OK IDLE -- 54321\r\n");
  EXPECT_EQ(bench.Ask("/1 1 get system.serial\n"), "@01 1 RJ IDLE -- DEVICEONLY\r\n");
  EXPECT_EQ(bench.Ask("/1 1 get limit.max\n"), "@01 1 OK IDLE -- 3600000\r\n");
  EXPECT_EQ(bench.Ask("/1 1 get limit.cycle.dist\n"), "@01 1 OK IDLE -- 36000\r\n");
  EXPECT_EQ(bench.Ask("/1 1 get maxspeed\n"), "@01 1 OK IDLE -- 9830\r\n");  // 6000 x 1.6384
  EXPECT_EQ(bench.Ask("/1 1 get nonsense\n"), "@01 1 RJ IDLE -- BADCOMMAND\r\n");
  EXPECT_EQ(bench.Ask("/1 1 set maxspeed -5\n"), "@01 1 RJ IDLE -- BADDATA\r\n");
  EXPECT_EQ(bench.Ask("/1 1 set limit.max 1000\n"), "@01 1 OK IDLE -- 0\r\n");
  EXPECT_EQ(bench.Ask("/1 1 move abs 1001\n"), "@01 1 RJ IDLE -- BADDATA\r\n");
  EXPECT_EQ(bench.Ask("/1 1 jump\n"), "@01 1 RJ IDLE -- BADCOMMAND\r\n");
  EXPECT_EQ(bench.Ask("/1 tools echo a b\n"), "@01 0 OK IDLE -- a b\r\n");
}

TEST(ZaberFirmware, StopsAndIsInterrupted) {
  FirmwareBench bench = HomedZaber();
  bench.Ask("/1 1 move abs 9000\n");
  bench.Wait(700);
  EXPECT_EQ(bench.Ask("/1 1 stop\n"), "@01 1 OK BUSY NI 0\r\n");
  bench.Wait(260);
  EXPECT_NEAR(bench.True(), 42.0, 1.0);
  EXPECT_EQ(bench.Ask("/1 1 warnings clear\n"), "@01 1 OK IDLE -- 01 NI\r\n");
  EXPECT_EQ(bench.Ask("/1 1\n"), "@01 1 OK IDLE -- 0\r\n");
  bench.Ask("/1 1 move abs 0\n");
  bench.Wait(400);
  EXPECT_EQ(bench.Ask("/1 1 estop\n"), "@01 1 OK IDLE NI 0\r\n");
  const double there = bench.True();
  bench.Wait(300);
  EXPECT_EQ(bench.True(), there);
  EXPECT_EQ(bench.Ask("/1 1 move abs 100\n"),
            "@01 1 OK BUSY -- 0\r\n");  // it is over with the next
  bench.Wait(10);
  EXPECT_EQ(bench.Ask("/1 1 move abs 200\n"), "@01 1 OK BUSY NI 0\r\n");
}

TEST(ZaberFirmware, AlertsWhenItArrives) {
  FirmwareBench bench = HomedZaber();
  bench.Ask("/1 0 set comm.alert 1\n");
  bench.Ask("/1 1 move abs 100\n");
  EXPECT_EQ(bench.Wait(500), "!01 1 IDLE --\r\n");
}

TEST(ZaberFirmware, FlagsTellWhatWentWrong) {
  FirmwareBench bench =
      HomedZaber({AtAngle(FaultKind::kStall, 40.0), AtAngle(FaultKind::kLimit, 50.0),
                  AtAngle(FaultKind::kDisplaced, 60.0), AtAngle(FaultKind::kAlarm, 70.0),
                  AtAngle(FaultKind::kReset, 80.0)});
  bench.Ask("/1 1 move abs 4000\n");
  bench.Wait(2000);
  EXPECT_EQ(bench.Ask("/1 1 get pos\n"), "@01 1 OK IDLE FS 2000\r\n");
  EXPECT_EQ(bench.True(), 20.0);
  bench.Ask("/1 1 warnings clear\n");
  bench.Ask("/1 1 move abs 5000\n");
  bench.Wait(2000);
  EXPECT_EQ(bench.Ask("/1 1 get pos\n"), "@01 1 OK IDLE FE 3500\r\n");
  bench.Ask("/1 1 warnings clear\n");
  bench.Ask("/1 1 move abs 6000\n");
  bench.Wait(2000);
  EXPECT_EQ(bench.Ask("/1 1 get pos\n"), "@01 1 OK IDLE WM 6050\r\n");
  EXPECT_EQ(bench.True(), 60.5);
  bench.Ask("/1 1 warnings clear\n");
  EXPECT_EQ(bench.Ask("/1 1\n"), "@01 1 OK IDLE -- 0\r\n");
  bench.Ask("/1 1 move abs 7000\n");
  bench.Wait(600);
  EXPECT_EQ(bench.Ask("/1 1 move abs 7000\n"), "@01 1 RJ IDLE FD BADDATA\r\n");
  EXPECT_EQ(bench.Ask("/1 1 home\n"), "@01 1 RJ IDLE FD DRIVERDISABLED\r\n");
  bench.Wait(1000);
  EXPECT_EQ(bench.Ask("/1 1 home\n"), "@01 1 OK BUSY WR 0\r\n");
  bench.Wait(8000);
  bench.Ask("/1 1 move abs 8000\n");
  bench.Wait(2000);
  EXPECT_EQ(bench.Ask("/1 1 get pos\n"), "@01 1 OK IDLE WR 0\r\n");
}

TEST(ZaberFirmware, HomingThatFailsLeavesItWithoutReference) {
  FirmwareBench endless = Zaber({MakeFault(FaultKind::kNeverHomes)});
  endless.Ask("/1 1 home\n");
  endless.Wait(30000);
  EXPECT_EQ(endless.Ask("/1 1\n"), "@01 1 OK BUSY WR 0\r\n");
  endless.Ask("/1 1 stop\n");
  EXPECT_EQ(endless.Ask("/1 1\n"), "@01 1 OK IDLE WR 0\r\n");
  FirmwareBench stuck = Zaber({MakeFault(FaultKind::kStuckSwitch)});
  stuck.Ask("/1 1 home\n");
  stuck.Wait(9000);
  EXPECT_EQ(stuck.Ask("/1 1\n"), "@01 1 OK IDLE WR 0\r\n");
}

TEST(ZaberFirmware, AResetForgetsAndBoots) {
  FirmwareBench bench = HomedZaber();
  EXPECT_EQ(bench.Ask("/1 system reset\n/1 1\n"), "@01 0 OK IDLE -- 0\r\n");
  EXPECT_EQ(bench.Wait(300), "");
  EXPECT_EQ(bench.Ask("/1 1\n"), "@01 1 OK IDLE WR 0\r\n");
}

}  // namespace
}  // namespace turnlight::rig::sim::stage
