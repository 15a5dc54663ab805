// Proves that `simulate` says when its devices can be opened and where, that it ends cleanly and
// with counts after its time and on signals, that faults are told as they strike, that a second one
// at the same place is refused, that bad configs are named, and that what it writes of its rig can
// be read. Does not prove what the devices do; tests/rig/sim/stage and tests/rig/sim/gige do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <functional>
#include <string>

#include "rig/rig_calibration.h"
#include "tests/app/program.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class Simulate : public testing::Test {
 protected:
  // Of this process alone.
  static std::string Address() {
    const int pid = ::getpid();
    return "127." + std::to_string(90 + pid / 65024 % 8) + "." + std::to_string(pid / 254 % 256) +
           "." + std::to_string(1 + pid % 254);
  }
  std::string Link() const { return folder_ / "stage"; }
  std::string Table() const { return "  table: {firmware: grbl, link: " + Link() + "}\n"; }
  static std::string Camera() {
    return "  camera: {address: " + Address() + ", serial: T-1, pixel_format: Mono12}\n";
  }
  // A small scene.
  std::string Config(const std::string& devices, const std::string& more = "") const {
    const std::string path = folder_ / "sim.yaml";
    WriteText(path,
              "camera: {size: [64, 48], focal_px: 120}\nmotion: {kind: table}\n"
              "samples_per_side: 1\n" +
                  more + "devices:\n" + devices);
    return path;
  }
  pid_t Begin(const std::string& config) const {
    return Start({"simulate", config}, folder_ / "err", folder_ / "out");
  }
  std::string Out() const { return ReadText(folder_ / "out"); }
  std::string Err() const { return ReadText(folder_ / "err"); }
  // Within ten seconds.
  static bool Comes(const std::function<bool()>& condition) {
    for (int i = 0; i < 2000 && !condition(); ++i) ::usleep(5000);
    return condition();
  }
  bool IsReady() const {
    return Comes([this] { return Lines(folder_ / "out") > 0; });
  }

  TemporaryFolder folder_;
};

TEST_F(Simulate, SaysWhereItsDevicesAreAndEndsAfterItsTime) {
  const Outcome outcome = RunProgram({"simulate", Config(Table() + Camera()), "--for", "0.2"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.out, "ready: table grbl at " + Link() + ", camera T-1 at " + Address() +
                             "\nend: 0 moves, 0 triggers, 0 frames, 0 faults struck\n");
  EXPECT_EQ(outcome.err, "");
  EXPECT_FALSE(fs::is_symlink(Link()));
}

TEST_F(Simulate, SignalsEndItCleanly) {
  const std::string config = Config(Table() + Camera());
  for (const int signal : {SIGTERM, SIGINT}) {
    const pid_t process = Begin(config);
    ASSERT_TRUE(IsReady()) << Err();
    EXPECT_TRUE(fs::is_symlink(Link()));
    ::kill(process, signal);
    EXPECT_EQ(Finish(process), 0);
    EXPECT_THAT(Out(), HasSubstr("\nend: "));
    EXPECT_FALSE(fs::is_symlink(Link()));
    fs::remove(folder_ / "out");
  }
}

TEST_F(Simulate, ASecondOneIsRefusedWhereTheFirstIs) {
  const std::string config = Config(Table() + Camera());
  const pid_t process = Begin(config);
  ASSERT_TRUE(IsReady()) << Err();
  const std::string holder = "process " + std::to_string(process);
  const Outcome at_link = RunProgram({"simulate", config});
  EXPECT_EQ(at_link.exit_code, 2);
  EXPECT_EQ(at_link.out, "");
  EXPECT_THAT(at_link.err, HasSubstr(Link()));
  EXPECT_THAT(at_link.err, HasSubstr(holder));
  const Outcome at_address = RunProgram({"simulate", config, "--link", folder_ / "other"});
  EXPECT_EQ(at_address.exit_code, 2);
  EXPECT_THAT(at_address.err, HasSubstr(Address() + ":3956: taken by " + holder));
  EXPECT_FALSE(fs::is_symlink(folder_ / "other"));
  EXPECT_TRUE(fs::is_symlink(Link()));
  ::kill(process, SIGTERM);
  EXPECT_EQ(Finish(process), 0);
}

TEST_F(Simulate, ADeviceAloneIsEnough) {
  const Outcome table = RunProgram({"simulate", Config(Table()), "--for", "0.1"});
  EXPECT_EQ(table.out, "ready: table grbl at " + Link() + "\nend: 0 moves, 0 faults struck\n");
  const Outcome camera = RunProgram({"simulate", Config(Camera()), "--for", "0.1"});
  EXPECT_EQ(camera.out,
            "ready: camera T-1 at " + Address() + "\nend: 0 triggers, 0 frames, 0 faults struck\n");
}

TEST_F(Simulate, FaultsAreToldAsTheyStrike) {
  const std::string config = Config(
      Table(), "faults: {list: [{at: {time_s: 0.05}, device: table, fault: unplugged, ms: 50}]}\n");
  const Outcome told = RunProgram({"simulate", config, "--for", "0.5"});
  EXPECT_THAT(told.err, HasSubstr("fault: unplugged of the table at 0 degrees, after 0."));
  EXPECT_THAT(told.out, HasSubstr("1 faults struck"));
  EXPECT_EQ(RunProgram({"simulate", config, "--for", "0.5", "--quiet"}).err, "");
}

TEST_F(Simulate, BadConfigsAreNamed) {
  struct {
    std::string devices, more, message;
  } const cases[] = {
      {"  {}\n", "", "devices: it is empty, allowed is table, camera or both"},
      {Table(), "lamps: 3\n", "sim.yaml:4: lamps: unknown key"},
      {"  camera: {pixel_format: Mono9}\n", "", "devices/camera/pixel_format: \"Mono9\""},
      {"  table: {firmware: grbl}\n", "", "devices/table/link"},
      {Table(), "keyframes: {count: 0}\n", "keyframes/count: 0, allowed"},
      {Table(), "faults: {list: [{at: {keyframe: 36}, fault: stall}]}\n",
       "faults/list/0/at/keyframe: 36, allowed"}};
  for (const auto& bad : cases) {
    const std::string config = Config(bad.devices, bad.more);
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"simulate", config}, {"config", "check", config}}) {
      const Outcome outcome = RunProgram(command);
      EXPECT_EQ(outcome.exit_code, 2);
      EXPECT_THAT(outcome.err, HasSubstr(bad.message));
    }
  }
}

TEST_F(Simulate, OptionsThatFitNoDeviceAreRefused) {
  const Outcome link = RunProgram({"simulate", Config(Camera()), "--link", "/tmp/x"});
  EXPECT_EQ(link.exit_code, 2);
  EXPECT_THAT(link.err, HasSubstr("--link names the port"));
  const Outcome address = RunProgram({"simulate", Config(Camera()), "--address", "there"});
  EXPECT_EQ(address.exit_code, 2);
  EXPECT_THAT(address.err, HasSubstr("--address: there, allowed is an IPv4 address"));
  const Outcome calibration =
      RunProgram({"simulate", Config(Camera()), "--calibration", folder_ / "c.json"});
  EXPECT_EQ(calibration.exit_code, 2);
  EXPECT_THAT(calibration.err, HasSubstr("no table, allowed for a calibration are both"));
}

TEST_F(Simulate, WritesWhatIsTrueOfItsRig) {
  const Outcome outcome = RunProgram({"simulate", Config(Table() + Camera()), "--calibration",
                                      folder_ / "c.json", "--truth", folder_ / "truth.json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  const auto calibration = rig::ReadRigCalibration(fs::path(folder_ / "c.json"));
  ASSERT_TRUE(calibration) << calibration.error().text;
  EXPECT_EQ(calibration->radiometry.white, 4095.0);
  EXPECT_EQ(calibration->devices.camera.serial, "T-1");
  EXPECT_EQ(calibration->devices.resolution, cv::Size(64, 48));
  EXPECT_THAT(calibration->devices.table.model, HasSubstr("Grbl 1.1h"));
  EXPECT_THAT(ReadText(folder_ / "truth.json"), HasSubstr("\"lights\""));
}

}  // namespace
}  // namespace turnlight::app
