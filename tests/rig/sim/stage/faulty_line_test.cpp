// Proves that each fault of a serial line does to the controller's messages what its row in
// rig/sim/fault_script.h says, once, at its angle. Does not prove what a driver makes of it.
#include "rig/sim/stage/faulty_line.h"

#include "tests/rig/sim/stage/firmware_bench.h"

namespace turnlight::rig::sim::stage {
namespace {

using std::chrono::milliseconds;

const FirmwareMessage kOk{MessageKind::kReply, "ok\r\n"};
const FirmwareMessage kReport{MessageKind::kStatus, "<Idle|MPos:10.000,0.000,0.000|FS:0,0>\r\n"};

struct LineBench {
  explicit LineBench(std::vector<FaultEntry> entries)
      : faults(std::make_shared<FaultScript>(std::move(entries))),
        table(std::make_shared<MockTurntable>(RigidTable(TableFeedback::kOpenLoop))),
        line(faults, table) {}

  std::string Send(const FirmwareMessage& message) {
    line.Send(message, now);
    return line.Take(now);
  }
  std::string After(int ms) {
    now += milliseconds(ms);
    return line.Take(now);
  }

  std::shared_ptr<FaultScript> faults;
  std::shared_ptr<MockTurntable> table;
  FaultyLine line;
  DeviceTime now{std::chrono::seconds(1)};
};

TEST(FaultyLine, WithoutFaultsEverythingComesAtOnce) {
  LineBench bench({});
  EXPECT_EQ(bench.Send(kOk), kOk.bytes);
  EXPECT_EQ(bench.Send(kReport), kReport.bytes);
  FaultyLine none(nullptr, bench.table);
  none.Send(kOk, bench.now);
  EXPECT_EQ(none.Take(bench.now), kOk.bytes);
}

TEST(FaultyLine, RepliesAreDroppedDoubledAndLate) {
  LineBench dropped({MakeFault(FaultKind::kDroppedReply)});
  EXPECT_EQ(dropped.Send(kReport), kReport.bytes);  // no reply: not its occasion
  EXPECT_EQ(dropped.Send(kOk), "");
  EXPECT_EQ(dropped.Send(kOk), kOk.bytes);
  LineBench doubled({MakeFault(FaultKind::kDuplicateReply)});
  EXPECT_EQ(doubled.Send(kOk), "ok\r\nok\r\n");
  LineBench late({MakeFault(FaultKind::kLateReply)});
  EXPECT_EQ(late.Send(kOk), "");
  EXPECT_EQ(late.Send(kReport), kReport.bytes);
  EXPECT_EQ(late.After(399), "");
  EXPECT_EQ(late.After(1), "ok\r\n");
}

TEST(FaultyLine, ReportsAreSwallowedAndAltered) {
  LineBench lost({MakeFault(FaultKind::kLostStatus)});
  EXPECT_EQ(lost.Send(kReport), "");
  EXPECT_EQ(lost.Send(kReport), kReport.bytes);
  FaultEntry often = MakeFault(FaultKind::kAlteredStatus);
  often.times = 200;
  LineBench altered({often});
  for (int i = 0; i < 200; ++i) {
    const std::string report = altered.Send(kReport);
    ASSERT_EQ(report.size(), kReport.bytes.size());
    int differ = 0;
    for (std::size_t k = 0; k < report.size(); ++k) differ += report[k] != kReport.bytes[k];
    EXPECT_EQ(differ, 1);
    EXPECT_THAT(report, ::testing::EndsWith("\r\n"));
  }
}

TEST(FaultyLine, GarbageNulsAndFloodsComeWithTheMessage) {
  LineBench garbage({MakeFault(FaultKind::kSerialGarbage)});
  const std::string noise = garbage.Send(kOk);
  EXPECT_EQ(noise.size(), 44u);
  EXPECT_THAT(noise, ::testing::EndsWith("ok\r\n"));
  EXPECT_EQ(noise.find('\x13'), std::string::npos);
  LineBench nuls({MakeFault(FaultKind::kNulBytes)});
  std::string holed = nuls.Send(kReport);
  EXPECT_EQ(std::count(holed.begin(), holed.end(), '\0'), 3);
  holed.erase(std::remove(holed.begin(), holed.end(), '\0'), holed.end());
  EXPECT_EQ(holed, kReport.bytes);
  LineBench flood({MakeFault(FaultKind::kLongLine)});
  EXPECT_EQ(flood.Send(kOk), std::string(4096, 'x') + "ok\r\n");
}

TEST(FaultyLine, ASplitLineComesByteByByteAndTheNextAfterIt) {
  FaultEntry split = MakeFault(FaultKind::kSplitLine);
  split.amount = 10.0;
  LineBench bench({split});
  EXPECT_EQ(bench.Send(kOk), "o");
  EXPECT_EQ(bench.Send(kReport), "");
  EXPECT_EQ(bench.After(10), "k");
  EXPECT_EQ(bench.After(10), "\r");
  EXPECT_EQ(bench.After(20), "\n" + kReport.bytes);
  bench.Send(kReport);
  bench.line.Clear();
  EXPECT_EQ(bench.After(100), "");
}

TEST(FaultyLine, StrikesWhileItsAngleIsCommanded) {
  LineBench bench({AtAngle(FaultKind::kDroppedReply, 30.0)});
  EXPECT_EQ(bench.Send(kOk), kOk.bytes);
  bench.table->Drive(30.0, 10.0, 100.0, bench.now);
  EXPECT_EQ(bench.Send(kOk), "");
  EXPECT_EQ(bench.Send(kOk), kOk.bytes);
}

TEST(FaultyLine, IsSilentForItsTime) {
  LineBench bench({AtAngle(FaultKind::kSilent, 30.0)});
  EXPECT_FALSE(bench.line.IsSilent(bench.now));
  bench.table->Drive(30.0, 10.0, 100.0, bench.now);
  EXPECT_TRUE(bench.line.IsSilent(bench.now));
  EXPECT_TRUE(bench.line.IsSilent(bench.now + milliseconds(1499)));
  EXPECT_FALSE(bench.line.IsSilent(bench.now + milliseconds(1500)));
}

}  // namespace
}  // namespace turnlight::rig::sim::stage
