// Proves of the program against simulated devices in another process, on their real protocols: a
// run gives the frames of the mock rig byte by byte and its result; the simulator or the capture
// killed in the middle, or Ctrl-C twice: it ends in time with its exit code, the motor stands, and
// a resume completes the session to the same content; a replay of the log gives the session and
// the result; a second program is refused at the port and at the camera and told who has it; no
// privileges are needed. Does not prove: anything of real devices.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tests/app/listener.h"
#include "tests/app/program.h"

namespace turnlight::loop {
namespace {

namespace fs = std::filesystem;
using app::Outcome;
using app::OwnAddress;
using app::ReadText;
using app::Replace;
using app::RunProgram;
using app::WriteText;
using testing::AllOf;
using testing::HasSubstr;

constexpr int kFrames = 8;

// Within 30 seconds.
bool Comes(const std::function<bool()>& condition) {
  for (int i = 0; i < 6000 && !condition(); ++i) ::usleep(5000);
  return condition();
}

std::string ConfigText(const std::string& name) {
  std::string text = ReadText(fs::path(TURNLIGHT_SOURCE_DIR) / "configs" / name);
  Replace(text, "step_deg: 10", "step_deg: 45");
  Replace(text, "count: 36", "count: 8");
  return text;
}

// Ended with it.
class SimulatorProcess {
 public:
  SimulatorProcess(const std::string& config, const std::string& out)
      : process_(app::Start({"simulate", config}, out + ".err", out)) {
    EXPECT_TRUE(Comes([&] { return app::Lines(out) > 0; })) << ReadText(out + ".err");
  }
  ~SimulatorProcess() {
    if (process_ <= 0) return;
    ::kill(process_, SIGTERM);
    EXPECT_EQ(app::Finish(process_), 0);
  }
  SimulatorProcess(const SimulatorProcess&) = delete;
  SimulatorProcess& operator=(const SimulatorProcess&) = delete;
  void Kill() {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    process_ = -1;
  }

 private:
  pid_t process_;
};

// Copies of a rig's two configs with a port and an address of their own, eight small frames.
// Opens pseudo-terminals until one has this name, or somebody else has it: programs beside this one
// free others.
std::vector<int> TakeNamesUpTo(const fs::path& name) {
  std::vector<int> taken;
  for (int i = 0; i < 64; ++i) {
    taken.push_back(::posix_openpt(O_RDWR | O_NOCTTY));
    const char* opened = ::ptsname(taken.back());
    if (opened != nullptr && name == opened) break;
  }
  return taken;
}

class LoopProcess : public testing::Test {
 protected:
  void Write(const std::string& firmware) {
    const std::string port = "/tmp/turnlight_hil_" + firmware;
    std::string sim = ConfigText("sim_" + firmware + ".yaml");
    Replace(sim, port, folder_ / "port");
    Replace(sim, "address: 127.0.0.1", "address: " + OwnAddress());
    Replace(sim, "size: [320, 240], focal_px: 640", "size: [160, 120], focal_px: 320");
    Replace(sim, "max_speed_deg_s: 60", "max_speed_deg_s: 180");
    Replace(sim, "acceleration_deg_s2: 400", "acceleration_deg_s2: 2000");
    Replace(sim, "home_speed_deg_s: 90", "home_speed_deg_s: 360");
    WriteText(sim_, sim);
    std::string rig = ConfigText("hil_" + firmware + ".yaml");
    Replace(rig, "port: " + port, "port: " + (folder_ / "port"));
    Replace(rig, "id: 127.0.0.1", "id: " + OwnAddress());
    Replace(rig, "size: [320, 240]", "size: [160, 120]");
    Replace(rig, "speed_deg_s: 60", "speed_deg_s: 180");
    Replace(rig, "acceleration_deg_s2: 400", "acceleration_deg_s2: 2000");
    WriteText(rig_, rig);
    fs::create_directory(folder_ / "hil");
    const Outcome written =
        RunProgram({"simulate", sim_, "--calibration", folder_ / ("hil/" + firmware + ".json"),
                    "--target", folder_ / "hil/target.ply"});
    ASSERT_EQ(written.exit_code, 0) << written.err;
  }
  // With moves of 22 s.
  std::string SlowRig() {
    std::string text = ReadText(rig_);
    Replace(text, "speed_deg_s: 180", "speed_deg_s: 2");
    Replace(text, "move_timeout_s: 20", "move_timeout_s: 90");
    Replace(text, "approach: one-sided", "approach: direct");
    WriteText(folder_ / "slow.yaml", text);
    return folder_ / "slow.yaml";
  }
  std::string MockConfig() {
    std::string text = ConfigText("simulated_turntable.yaml");
    Replace(text, "size: [320, 240], focal_px: 640", "size: [160, 120], focal_px: 320");
    Replace(text, "bits: 16", "bits: 8");
    WriteText(folder_ / "mock.yaml", text);
    return folder_ / "mock.yaml";
  }
  static std::size_t JournalLines(const std::string& out) {
    return app::Lines(out + "/session/journal.jsonl");
  }
  pid_t StartCapture(const std::string& config, const std::string& out, std::size_t lines) {
    const pid_t process = app::Start({"capture", config, "--out", out}, out + ".err");
    EXPECT_TRUE(Comes([&] { return JournalLines(out) >= lines; })) << ReadText(out + ".err");
    return process;
  }
  std::string Uninterrupted() {
    const Outcome whole = RunProgram({"capture", rig_, "--out", folder_ / "whole"});
    EXPECT_EQ(whole.exit_code, 0) << whole.err;
    return app::ContentOf(folder_ / "whole/session");
  }
  void ExpectResumeCompletes(const std::string& out) {
    const std::size_t lines = JournalLines(out);
    EXPECT_LT(lines, kFrames + 1u) << "nothing was left to do";
    const Outcome resumed = RunProgram({"resume", out});
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_EQ(app::ContentOf(out + "/session"), Uninterrupted());
  }

  const TemporaryFolder folder_;
  const std::string sim_ = folder_ / "sim.yaml", rig_ = folder_ / "rig.yaml",
                    out_ = folder_ / "out", ready_ = folder_ / "ready";
};

class LoopProcessOf : public LoopProcess, public testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override { Write(GetParam()); }
};

TEST_P(LoopProcessOf, GivesTheMocksFramesAndResultAndSoDoesItsReplay) {
  const SimulatorProcess simulator(sim_, ready_);
  const Outcome run = RunProgram({"run", rig_, "--out", out_});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Outcome mock = RunProgram({"run", MockConfig(), "--out", folder_ / "mock"});
  ASSERT_EQ(mock.exit_code, 0) << mock.err;
  std::size_t pictures = 0;
  for (const auto& file : fs::directory_iterator(out_ + "/session/frames")) {
    const fs::path other = folder_ / ("mock/session/frames/" + file.path().filename().string());
    EXPECT_TRUE(ReadText(file.path()) == ReadText(other)) << file.path();
    ++pictures;
  }
  EXPECT_GE(pictures, static_cast<std::size_t>(kFrames));
  for (const std::string part : {"/session", "/result"}) {
    const Outcome compared = RunProgram({"compare", (folder_ / "mock") + part, out_ + part});
    EXPECT_EQ(compared.exit_code, 0) << compared.out << compared.err;
  }
  const std::string again = folder_ / "again";
  const Outcome replayed = RunProgram({"replay", out_ + "/log", "--out", again});
  EXPECT_EQ(replayed.exit_code, 0) << replayed.err;
  EXPECT_EQ(app::ContentOf(again + "/session"), app::ContentOf(out_ + "/session"));
  EXPECT_EQ(app::ResultWithoutTimes(again + "/result"), app::ResultWithoutTimes(out_ + "/result"));
}

// The frames are safe, and with a simulator begun anew, whose port has another name behind the
// link, the session is completed as if nothing had been.
TEST_P(LoopProcessOf, ASimulatorKilledInMidCaptureEndsItInTimeAndItResumes) {
  SimulatorProcess simulator(sim_, ready_);
  const pid_t capture = StartCapture(rig_, out_, 4);
  const fs::path port = fs::read_symlink(folder_ / "port");
  // As the system does with a device that is gone. A link to a name that came free would lead the
  // capture to another test's stage.
  fs::remove(folder_ / "port");
  simulator.Kill();
  const auto killed = std::chrono::steady_clock::now();
  EXPECT_EQ(app::Finish(capture), 4) << ReadText(out_ + ".err");
  const std::chrono::duration<double> after = std::chrono::steady_clock::now() - killed;
  EXPECT_LT(after.count(), 10.0) << ReadText(out_ + ".err");
  RecordProperty("seconds_to_the_end", std::to_string(after.count()));
  EXPECT_GE(JournalLines(out_), 4u);
  EXPECT_THAT(ReadText(out_ + ".err"), HasSubstr("the others are safe; turnlight resume"));
  const std::vector<int> taken = TakeNamesUpTo(port);
  const SimulatorProcess anew(sim_, folder_ / "anew");
  EXPECT_NE(fs::read_symlink(folder_ / "port"), port);
  ExpectResumeCompletes(out_);
  for (const int terminal : taken) ::close(terminal);
}

TEST_P(LoopProcessOf, ACaptureKilledResumes) {
  const SimulatorProcess simulator(sim_, ready_);
  const pid_t capture = StartCapture(rig_, out_, 3);
  ::kill(capture, SIGKILL);
  EXPECT_EQ(app::Finish(capture), -1);
  ExpectResumeCompletes(out_);
}

INSTANTIATE_TEST_SUITE_P(Firmwares, LoopProcessOf, testing::Values("grbl", "zaber"),
                         [](const auto& info) { return std::string(info.param); });

// What a GRBL says of itself to whoever opens its port: "<Idle|MPos:1.000,0.000,0.000".
std::string GrblStatus(const std::string& port) {
  const int handle = ::open(port.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
  if (handle < 0) return "no port";
  termios settings{};
  ::tcgetattr(handle, &settings);
  ::cfmakeraw(&settings);
  ::tcsetattr(handle, TCSANOW, &settings);
  std::string said;
  if (::write(handle, "?", 1) == 1)
    for (int i = 0; i < 200 && said.find('>') == std::string::npos; ++i) {
      pollfd wait{handle, POLLIN, 0};
      char bytes[256];
      if (::poll(&wait, 1, 10) <= 0) continue;
      if (const auto count = ::read(handle, bytes, sizeof bytes); count > 0)
        said.append(bytes, static_cast<std::size_t>(count));
    }
  ::close(handle);
  const std::size_t begin = said.rfind('<');
  return begin == std::string::npos ? said : said.substr(begin, said.find("|FS", begin) - begin);
}

class GrblProcess : public LoopProcess {
 protected:
  void SetUp() override {
    Write("grbl");
    // So that its port can be opened later to ask what it does.
    std::string sim = ReadText(sim_);
    Replace(sim, "firmware: grbl", "firmware: grbl\n    reset_on_open: false");
    WriteText(sim_, sim);
  }
  void ExpectTheMotorStands() const {
    const std::string first = GrblStatus(folder_ / "port");
    ::usleep(300'000);
    const std::string second = GrblStatus(folder_ / "port");
    EXPECT_THAT(first, HasSubstr("<Idle|MPos:"));
    EXPECT_EQ(first, second);
    EXPECT_EQ(JournalLines(out_), 2u);
  }
};

TEST_F(GrblProcess, CtrlCTwiceInAMoveStopsTheMotor) {
  const SimulatorProcess simulator(sim_, ready_);
  const pid_t capture = StartCapture(SlowRig(), out_, 2);
  ::usleep(600'000);  // past the rest of the frame: it moves, for 22 s
  ::kill(capture, SIGINT);
  ::usleep(200'000);
  EXPECT_EQ(::waitpid(capture, nullptr, WNOHANG), 0) << "it waits for the move";
  ::kill(capture, SIGINT);
  EXPECT_EQ(app::Finish(capture), 130) << ReadText(out_ + ".err");
  ExpectTheMotorStands();
}

TEST_F(GrblProcess, SigtermInAMoveStopsTheMotor) {
  const SimulatorProcess simulator(sim_, ready_);
  const pid_t capture = StartCapture(SlowRig(), out_, 2);
  ::usleep(600'000);
  ::kill(capture, SIGTERM);
  EXPECT_EQ(app::Finish(capture), 130) << ReadText(out_ + ".err");
  ExpectTheMotorStands();
}

// With nobody at the other end of its outputs it stops as by SIGTERM.
class AbandonedGrblProcess : public GrblProcess, public testing::WithParamInterface<app::Line> {};

TEST_P(AbandonedGrblProcess, StopsTheMotor) {
  const SimulatorProcess simulator(sim_, ready_);
  app::Listener listener(GetParam(), {"capture", SlowRig(), "--out", out_});
  EXPECT_TRUE(Comes([&] { return JournalLines(out_) >= 2; }));
  ::usleep(600'000);
  listener.Leave();
  EXPECT_EQ(listener.Finish(), 130);
  ExpectTheMotorStands();
  EXPECT_FALSE(fs::exists(fs::path(out_) / "run.lock"));
}
INSTANTIATE_TEST_SUITE_P(Loop, AbandonedGrblProcess,
                         testing::Values(app::Line::kTerminal, app::Line::kPipeOfErrors),
                         [](const auto& info) {
                           return info.param == app::Line::kTerminal ? "terminal" : "pipe";
                         });

// The port and the camera each by themselves.
TEST_F(GrblProcess, ASecondProgramIsRefusedAndToldWhoIsThere) {
  const SimulatorProcess simulator(sim_, ready_);
  const pid_t capture = StartCapture(SlowRig(), out_, 2);
  const Outcome at_camera = RunProgram({"capture", rig_, "--out", folder_ / "second"});
  EXPECT_EQ(at_camera.exit_code, 4);
  EXPECT_THAT(at_camera.err,
              AllOf(HasSubstr("camera SIM-GRBL-CAM"),
                    HasSubstr("in use by: process " + std::to_string(capture) + " (turnlight)")));
  const Outcome at_port = RunProgram({"home", rig_});
  EXPECT_EQ(at_port.exit_code, 4);
  EXPECT_THAT(at_port.err,
              AllOf(HasSubstr("grbl: /dev/pts/"),
                    HasSubstr("in use by turnlight (process " + std::to_string(capture) + ")")));
  EXPECT_FALSE(fs::exists(folder_ / "second"));
  ::kill(capture, SIGTERM);
  EXPECT_EQ(app::Finish(capture), 130);
  EXPECT_EQ(JournalLines(out_), 2u) << ReadText(out_ + ".err");
}

// A table without an encoder says that it stands where it does not, and goes on from there.
TEST_F(GrblProcess, StepsLostByAnOpenLoopAreSeenByTheClosure) {
  std::string sim = ReadText(sim_), rig = ReadText(rig_);
  Replace(sim, "faults: {list: []}",
          "faults: {list: [{at: {keyframe: 3}, fault: lost_steps, deg: 2}]}");
  Replace(rig, "retries: 3", "retries: 3\n  closure: true");
  WriteText(sim_, sim);
  WriteText(rig_, rig);
  const SimulatorProcess simulator(sim_, ready_);
  const Outcome run = RunProgram({"capture", rig_, "--out", out_});
  EXPECT_EQ(run.exit_code, 4) << run.err;
  EXPECT_THAT(run.err, HasSubstr("not to be trusted"));
  EXPECT_THAT(ReadText(ready_ + ".err"), HasSubstr("fault: lost_steps of the table"));
  const Outcome verified = RunProgram({"verify", out_ + "/session"});
  EXPECT_THAT(verified.out, HasSubstr("remark: closure: "));
}

// Everything as a user whom nothing belongs to.
TEST_F(GrblProcess, NeedsNoPrivileges) {
  if (::getuid() != 0) GTEST_SKIP() << "the other tests run without privileges already";
  constexpr uid_t kNobody = 65534;
  fs::create_directory(folder_ / "nobody");
  ASSERT_EQ(::chown(folder_.path().c_str(), kNobody, kNobody), 0);
  for (const auto& file : fs::recursive_directory_iterator(folder_.path()))
    ASSERT_EQ(::chown(file.path().c_str(), kNobody, kNobody), 0) << file.path();
  const auto quoted = [](const std::string& path) { return " '" + path + "'"; };
  const std::string as_nobody =
      "setpriv --reuid 65534 --regid 65534 --clear-groups" + quoted(TURNLIGHT_PROGRAM);
  const std::string script =
      as_nobody + " simulate" + quoted(sim_) + " >" + quoted(ready_) +
      " & simulator=$!; for i in $(seq 300); do [ -s" + quoted(ready_) + " ] && break; " +
      "sleep 0.1; done; " + as_nobody + " capture" + quoted(rig_) + " --out" + quoted(out_) +
      " 2>" + quoted(out_ + ".err") + "; code=$?; kill $simulator; wait $simulator; exit $code";
  const int status = ::system(script.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 0) << ReadText(out_ + ".err");
  EXPECT_EQ(JournalLines(out_), kFrames + 1u);
}

}  // namespace
}  // namespace turnlight::loop
