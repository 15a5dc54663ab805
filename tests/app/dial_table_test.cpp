// Proves: the table driver that docs/hardware.md adds speaks its language, whichever way its
// replies are split, believes no arrival that is not proven, and is homed and moved by the
// program's own commands over a port, once it has a line in the table of drivers. Does not prove:
// anything of real hardware.
#include "tests/app/dial_table.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "app/device_commands.h"
#include "base/format.h"
#include "tests/app/program.h"
#include "tests/rig/serial/transcript.h"

namespace turnlight::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// The controller, on a pseudo-terminal. It arrives after the first look at it.
class DialController {
 public:
  DialController() : master_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    grantpt(master_);
    unlockpt(master_);
    path_ = ptsname(master_);
    termios raw{};
    tcgetattr(master_, &raw);
    cfmakeraw(&raw);
    tcsetattr(master_, TCSANOW, &raw);
    thread_ = std::thread([this] { Run(); });
  }
  ~DialController() {
    stop_ = true;
    thread_.join();
    close(master_);
  }
  DialController(const DialController&) = delete;
  DialController& operator=(const DialController&) = delete;
  std::string path() const { return path_; }

 private:
  std::string Answer(const std::string& request) {
    if (request == "ID") return "=ID DIAL 2 SN17";
    if (request == "AT")
      return "=AT " + std::exchange(state_, state_ == "LOST" ? "LOST" : "READY") +
             Format(" %.2f", position_deg_);
    if (request.starts_with("GO ")) position_deg_ = std::stod(request.substr(3));
    if (request == "HOME") position_deg_ = 0.0;
    state_ = "MOVING";
    return "=" + request.substr(0, request.find(' '));
  }
  void Run() {
    std::string line;
    while (!stop_) {
      pollfd file{master_, POLLIN, 0};
      char byte = 0;
      if (poll(&file, 1, 20) <= 0 || !(file.revents & POLLIN) || read(master_, &byte, 1) != 1) {
        // Nobody has the other end open.
        if (file.revents & POLLHUP) std::this_thread::sleep_for(std::chrono::milliseconds(5));
      } else if (byte != '\n') {
        line += byte;
      } else {
        const std::string answer = Answer(std::exchange(line, "")) + "\r\n";
        if (write(master_, answer.data(), answer.size()) < 0) stop_ = true;
      }
    }
  }

  std::string path_, state_ = "LOST";
  double position_deg_ = 0.0;
  int master_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

std::string Played(const std::string& script) {
  const std::string begin = R"(! connect
                               > ID
                               < =ID DIAL 2 SN17
                               = identified 'DIAL 2'
                               > AT
                               < =AT READY 0.00
                               = idle 0
                               )";
  return rig::serial::PlayTranscript(
      [] { return rig::serial::Conversation{.protocol = MakeDialProtocol()}; },
      begin + script + "\n.\n");
}

TEST(DialTable, ArrivesWhenTheControllerSaysSo) {
  EXPECT_EQ(Played(R"(! move 120
                      > GO 120.00
                      < =AT READY 0.00
                      < =GO
                      > AT
                      < =AT MOVING 60.12
                      + 50
                      > AT
                      < =AT READY 120.00
                      = idle 120)"),
            "");
}

TEST(DialTable, ACommandThatIsNotAnsweredIsSentOnceMore) {
  EXPECT_EQ(Played(R"(! move 10
                      > GO 10.00
                      + 500
                      > GO 10.00
                      = note 'sent again'
                      < =GO
                      < =GO
                      > AT
                      < =AT READY 10.00
                      = idle 10
                      ! home
                      > HOME
                      + 500
                      > HOME
                      = note 'sent again'
                      + 500
                      = failed 'does not answer to HOME')"),
            "");
}

TEST(DialTable, WhatIsNoArrival) {
  EXPECT_EQ(Played(R"(! move 10
                      > GO 10.00
                      < =GO
                      > AT
                      < =AT READY 7.31
                      = fault 'on the way'
                      ! move 400
                      > GO 400.00
                      < !GO beyond the end
                      = note 'beyond the end'
                      > AT
                      < =AT READY 7.31
                      = fault 'beyond the end'
                      ! home
                      > HOME
                      < =HOME
                      > AT
                      < =AT LOST 3.00
                      = unhomed 'no reference'
                      + 50
                      > AT
                      < =AT FAULT 3.00 motor too hot
                      = fault 'motor too hot')"),
            "");
}

TEST(DialTable, AnotherControllerIsRefusedForGood) {
  EXPECT_EQ(rig::serial::PlayTranscript(
                [] { return rig::serial::Conversation{.protocol = MakeDialProtocol()}; },
                "! connect\n> ID\n< =ID DIAL 1 SN3\n= for-good 'allowed is DIAL 2'\n.\n"),
            "");
}

TEST(DialTable, TheProgramsCommandsMoveIt) {
  DialController controller;
  Drivers drivers = BuiltInDrivers();
  drivers.tables.push_back({"dial", RealDriver<rig::TableDevice>(MakeDialTable)});
  const TemporaryFolder folder;
  MotionArguments arguments;
  arguments.config = folder / "dial.yaml";
  WriteText(arguments.config, "rig: {table: {driver: dial, port: " + controller.path() + "}}\n");
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  EXPECT_EQ(RunJog(arguments, {.step = false, .deg = 30.0}, drivers), 0);
  EXPECT_EQ(RunJog(arguments, {.step = true, .deg = -10.5}, drivers), 0);
  EXPECT_EQ(testing::internal::GetCapturedStdout(),
            "the table stands at 30.000 degrees\nthe table stands at 19.500 degrees\n");
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              AllOf(HasSubstr("dial at " + controller.path() + ": Example, DIAL 2, SN17"),
                    HasSubstr("the dial has no reference: home it; homing comes first")));
}

}  // namespace
}  // namespace turnlight::app
