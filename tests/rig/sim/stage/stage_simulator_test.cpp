// Proves that each simulated controller can be talked to through its port by a plain termios
// client: 36 moves end where they should, opening resets what is to be reset, bytes take the time
// of the baud, an unplugged port comes back under its link and another name, and everything ends.
// Does not prove that the drivers get on with it.
#include "rig/sim/stage/stage_simulator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/rig/sim/stage/firmware_bench.h"
#include "tests/rig/sim/stage/port_client.h"

namespace turnlight::rig::sim::stage {
namespace {

namespace fs = std::filesystem;
using std::chrono::steady_clock;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

MockTurntableConfig QuickTable(TableFeedback feedback) {
  MockTurntableConfig table = RigidTable(feedback);
  table.max_speed_deg_s = table.home_speed_deg_s = 2000.0;
  table.acceleration_deg_s2 = 40000.0;
  return table;
}

StageConfig Quick(const PortFolder& folder, const std::string& firmware) {
  StageConfig config;
  config.link = folder / "port";
  config.table =
      QuickTable(firmware == "grbl" ? TableFeedback::kOpenLoop : TableFeedback::kEncoder);
  if (firmware == "grbl") {
    GrblConfig grbl;
    grbl.settings[22] = 1;
    config.firmware = grbl;
    config.reset_on_open = true;
  } else if (firmware == "zaber") {
    config.firmware = ZaberConfig{};
  } else {
    config.firmware = Smc100Config{};
    config.baud = 57600;
  }
  return config;
}

struct Running {
  explicit Running(const StageConfig& config, std::vector<FaultEntry> entries = {}) {
    auto started =
        StageSimulator::Start(config, std::make_shared<FaultScript>(std::move(entries)), epoch);
    EXPECT_TRUE(started) << started.error().text;
    if (started) simulator = std::move(*started);
  }
  DeviceTime Now() const { return steady_clock::now() - epoch; }
  double True() const { return simulator->table()->TrueAngleDeg(Now()); }

  SimulatorEpoch epoch = steady_clock::now();
  std::unique_ptr<StageSimulator> simulator;
};

void HomeGrbl(PortClient& client) {
  EXPECT_THAT(client.ReadUntil("unlock]\r\n"), StartsWith("\r\nGrbl 1.1h"));
  EXPECT_EQ(client.Ask("$H\n", "ok\r\n"), "ok\r\n");
}

// Asks until it answers.
void BootZaber(PortClient& client) {
  std::string reply;
  for (int i = 0; i < 200 && reply.empty(); ++i) {
    client.Write("/1 1\n");
    reply = client.ReadUntil("\n", 100);
  }
  while (!client.ReadUntil("\n", 200).empty()) continue;  // answers that came late
}

TEST(StageSimulator, GrblMakes36Moves) {
  const PortFolder folder;
  Running running(Quick(folder, "grbl"));
  PortClient client(folder / "port");
  HomeGrbl(client);
  for (int i = 1; i <= 36; ++i) {
    const std::string angle = std::to_string(10 * i);
    ASSERT_EQ(client.Ask("G90 G0 X" + angle + "\n", "ok\r\n"), "ok\r\n");
    ASSERT_EQ(client.Ask("G4 P0.01\n", "ok\r\n"), "ok\r\n");
    EXPECT_THAT(client.Ask("?", ">\r\n"), StartsWith("<Idle|MPos:" + angle + ".000,"));
    EXPECT_EQ(running.True(), 10.0 * i);
  }
}

TEST(StageSimulator, ZaberMakes36Moves) {
  const PortFolder folder;
  Running running(Quick(folder, "zaber"));
  PortClient client(folder / "port");
  const auto wait = [&] {
    std::string reply;
    for (int i = 0; i < 1000 && reply.find("IDLE --") == std::string::npos; ++i)
      reply = client.Ask("/1 1 get pos\n", "\n");
    return reply;
  };
  BootZaber(client);
  client.Ask("/1 1 home\n", "\n");
  EXPECT_EQ(wait(), "@01 1 OK IDLE -- 0\r\n");
  for (int i = 1; i <= 36; ++i) {
    const std::string steps = std::to_string(1000 * i);
    client.Ask("/1 1 move abs " + steps + "\n", "\n");
    EXPECT_EQ(wait(), "@01 1 OK IDLE -- " + steps + "\r\n");
    EXPECT_EQ(running.True(), 10.0 * i);
  }
}

TEST(StageSimulator, Smc100Makes36Moves) {
  const PortFolder folder;
  Running running(Quick(folder, "smc100"));
  PortClient client(folder / "port");
  const auto wait = [&](const std::string& state) {
    for (int i = 0; i < 1000; ++i) {
      client.Write("1TS\r\n");
      if (client.ReadUntil("\n", 100) == "1TS0000" + state + "\r\n") return true;
    }
    return false;
  };
  ASSERT_TRUE(wait("0A"));
  client.Write("1OR\r\n");
  ASSERT_TRUE(wait("32"));
  for (int i = 1; i <= 36; ++i) {
    const std::string angle = std::to_string(10 * i);
    client.Write("1PA" + angle + "\r\n");
    EXPECT_EQ(client.Ask("1TE\r\n", "\n"), "1TE@\r\n");
    ASSERT_TRUE(wait("33"));
    EXPECT_EQ(client.Ask("1TP\r\n", "\n"), "1TP" + angle + "\r\n");
    EXPECT_EQ(running.True(), 10.0 * i);
  }
}

TEST(StageSimulator, OpeningResetsAGrblIfItSaysSo) {
  for (const bool resets : {true, false}) {
    const PortFolder folder;
    StageConfig config = Quick(folder, "grbl");
    config.reset_on_open = resets;
    Running running(config);
    {
      PortClient first(folder / "port");
      first.Write("\n");
      first.ReadUntil("unlock]\r\n");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    PortClient second(folder / "port");
    if (resets) {
      EXPECT_THAT(second.ReadUntil("unlock]\r\n"), StartsWith("\r\nGrbl 1.1h"));
    } else {
      EXPECT_EQ(second.Ask("\n", "ok\r\n"), "ok\r\n");
    }
  }
}

TEST(StageSimulator, ReadsTheLastWordsOfAClient) {
  const PortFolder folder;
  StageConfig config = Quick(folder, "grbl");
  config.reset_on_open = false;
  Running running(config);
  {
    PortClient first(folder / "port");
    first.ReadUntil("unlock]\r\n");
    ASSERT_EQ(first.Ask("$X\n", "ok\r\n"), "[MSG:Caution: Unlocked]\r\nok\r\n");
    first.Write("M3S9\n$1=77\n");
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  PortClient second(folder / "port");
  EXPECT_THAT(second.Ask("?", ">\r\n"), HasSubstr("|FS:0,9"));
  EXPECT_THAT(second.Ask("$$\n", "ok\r\n"), HasSubstr("$1=77\r\n"));
}

TEST(StageSimulator, BytesTakeTheTimeOfTheBaud) {
  // About 360 bytes of settings: at 9600 baud 0.37 s, without a pace at once.
  for (const int baud : {9600, 0}) {
    const PortFolder folder;
    StageConfig config = Quick(folder, "grbl");
    config.baud = baud;
    Running running(config);
    PortClient client(folder / "port");
    client.ReadUntil("unlock]\r\n");
    const auto begin = steady_clock::now();
    const std::string settings = client.Ask("$$\n", "ok\r\n");
    const std::chrono::duration<double> took = steady_clock::now() - begin;
    const double least = baud == 0 ? 0.0 : 0.8 * static_cast<double>(settings.size()) / 960.0;
    EXPECT_GT(settings.size(), 300u);
    EXPECT_GE(took.count(), least);
    EXPECT_LE(took.count(), least + 5.0);
  }
}

TEST(StageSimulator, UnpluggedItComesBackUnderItsLinkAndAnotherName) {
  for (const std::string firmware : {"grbl", "zaber"}) {
    const PortFolder folder;
    FaultEntry unplugged = AtAngle(FaultKind::kUnplugged, 20.0);
    Running running(Quick(folder, firmware), {unplugged});
    const std::string before = running.simulator->port();
    EXPECT_EQ(fs::read_symlink(folder / "port"), before);
    {
      PortClient client(folder / "port");
      if (firmware == "grbl") {
        HomeGrbl(client);
        client.Write("G0X20\n");
      } else {
        BootZaber(client);
        client.Ask("/1 1 home\n", "\n");
        while (client.Ask("/1 1\n", "\n").find("IDLE") == std::string::npos) continue;
        client.Write("/1 1 move abs 2000\n");
      }
      EXPECT_TRUE(client.SeesHangUp());
      EXPECT_FALSE(fs::exists(fs::symlink_status(folder / "port")));
    }
    for (int i = 0; i < 2000 && running.simulator->port().empty(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const std::string after = running.simulator->port();
    EXPECT_NE(after, before);
    EXPECT_EQ(fs::read_symlink(folder / "port"), after);
    PortClient client(folder / "port");
    if (firmware == "grbl") {
      HomeGrbl(client);
    } else {  // it has a supply of its own and knows where it is
      EXPECT_EQ(client.Ask("/1 1 get pos\n", "\n"), "@01 1 OK IDLE -- 2000\r\n");
    }
  }
}

TEST(StageSimulator, IsSilentAndThenAnswersAll) {
  const PortFolder folder;
  FaultEntry silent = AtAngle(FaultKind::kSilent, 20.0);
  silent.amount = 2000.0;
  Running running(Quick(folder, "grbl"), {silent});
  PortClient client(folder / "port");
  HomeGrbl(client);
  client.Write("G0X20\n");
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  client.Write("?");
  EXPECT_THAT(client.ReadUntil(">\r\n", 100), ::testing::Not(HasSubstr("<")));
  EXPECT_THAT(client.ReadUntil(">\r\n"), HasSubstr("MPos:20.000,"));
}

TEST(StageSimulator, IsTheTableOfItsWorld) {
  const PortFolder folder;
  SimulationConfig config;
  config.table.power_on_deg = 33.0;
  config.faults = {MakeFault(FaultKind::kLostStatus)};
  auto world = BuildWorld(config);
  ASSERT_TRUE(world) << world.error().text;
  const auto document = ParseYaml(
      "{firmware: zaber, link: " + (folder / "port").string() + ", steps_per_deg: 88.8}", "s.yaml");
  ASSERT_TRUE(document);
  const auto epoch = steady_clock::now();
  const auto simulator = StartStage(StrictObject(*document), *world, epoch);
  ASSERT_TRUE(simulator) << simulator.error().text;
  EXPECT_EQ(world->table, (*simulator)->table());
  EXPECT_NEAR(world->table->TrueAngleDeg(steady_clock::now() - epoch), 33.0, 0.01);
  PortClient client(folder / "port");
  BootZaber(client);
  EXPECT_THAT(client.Ask("/1 1\n", "\n"), StartsWith("@01 1 OK IDLE WR"));
  EXPECT_EQ(world->faults->Remaining(), 0);  // the world's script is played
}

TEST(StageSimulator, EndsCleanlyAndAtMostOneHasALink) {
  const PortFolder folder;
  {
    Running running(Quick(folder, "grbl"));
    const auto second = StageSimulator::Start(Quick(folder, "zaber"), nullptr, running.epoch);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().kind, ErrorKind::kInput);
    EXPECT_THAT(second.error().text, HasSubstr("another simulator has this port"));
    PortClient client(folder / "port");
    running.simulator.reset();
    EXPECT_TRUE(client.SeesHangUp());
  }
  EXPECT_TRUE(fs::is_empty(folder / ""));
  const Running again(Quick(folder, "zaber"));
  EXPECT_TRUE(again.simulator);
}

}  // namespace
}  // namespace turnlight::rig::sim::stage
