// Proves: a table on a real port, through the real libserialport (serial_port_test) and through
// termios (serial_test): it opens, homes, moves and says so; repeated readings keep their time; a
// lost port is an error within a second and is found again under another path only after a homing;
// a second program is refused with the holder's name; every call returns at once. Does not prove:
// anything of a firmware's motion (the protocols' tests, and the captures in the loop).
#include "rig/serial/serial_turntable.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <thread>

#include "rig/serial/grbl/grbl_protocol.h"
#include "tests/rig/serial/tiny_controller.h"
#include "tests/temporary_folder.h"

namespace turnlight::rig::serial {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using testing::HasSubstr;

DeviceTime Now() { return std::chrono::steady_clock::now().time_since_epoch(); }

std::unique_ptr<SerialTurntable> TableAt(const std::string& path,
                                         SerialTurntableOptions options = {}) {
  options.driver = "grbl";
  options.port.path = path;
  return std::make_unique<SerialTurntable>(
      options, std::make_unique<grbl::GrblProtocol>(grbl::GrblOptions()));
}

// Open, and homed.
void OpenAndHome(SerialTurntable& table) {
  const auto identity = table.Open(Now());
  ASSERT_TRUE(identity) << identity.error().text;
  ASSERT_TRUE(table.Home(Now()));
}

// The first state that is not moving, or the error that comes instead.
Result<TableState> Await(SerialTurntable& table, int ms = 5000) {
  const DeviceTime by = Now() + milliseconds(ms);
  while (true) {
    const auto state = table.State(Now());
    if (!state || state->motion != TableMotion::kMoving || Now() > by) return state;
    std::this_thread::sleep_for(milliseconds(2));
  }
}

template <typename Condition>
bool Soon(Condition condition, int ms = 5000) {
  const DeviceTime by = Now() + milliseconds(ms);
  while (!condition()) {
    if (Now() > by) return false;
    std::this_thread::sleep_for(milliseconds(5));
  }
  return true;
}

// One controller at a link that can be pointed elsewhere.
class SerialTurntableTest : public testing::Test {
 protected:
  void Plug(const TinyController& controller) {
    fs::remove(link_);
    fs::create_symlink(controller.path(), link_);
  }
  TemporaryFolder folder_;
  const fs::path link_ = folder_ / "port";
};

TEST_F(SerialTurntableTest, OpensHomesAndMoves) {
  TinyController controller("TABLE 7");
  Plug(controller);
  const auto table = TableAt(link_);
  const auto identity = table->Open(Now());
  ASSERT_TRUE(identity) << identity.error().text;
  EXPECT_EQ(identity->serial, "TABLE 7");
  EXPECT_THAT(table->port_in_use(), HasSubstr(TURNLIGHT_PORT_BACKEND));
  ASSERT_TRUE(table->Home(Now()));
  ASSERT_EQ(Await(*table)->motion, TableMotion::kIdle);
  for (const double angle_deg : {10.0, 360.0, 1234.5}) {
    ASSERT_TRUE(table->MoveTo(angle_deg, Now()));
    // Never the Idle of before. This controller jumps: on a busy machine it has arrived already.
    const auto begun = table->State(Now());
    ASSERT_TRUE(begun);
    EXPECT_TRUE(begun->motion == TableMotion::kMoving || begun->angle_deg == angle_deg)
        << begun->angle_deg;
    const auto there = Await(*table);
    ASSERT_TRUE(there);
    EXPECT_EQ(there->motion, TableMotion::kIdle);
    EXPECT_DOUBLE_EQ(there->angle_deg, angle_deg);
  }
}

TEST_F(SerialTurntableTest, AReadingKeepsItsTimeUntilThereIsANewOne) {
  TinyController controller;
  const auto table = TableAt(controller.path());
  ASSERT_TRUE(table->Open(Now()));
  std::vector<DeviceTime> times;
  for (int i = 0; i < 300; ++i) {
    const DeviceTime now = Now();
    const auto state = Await(*table);
    ASSERT_TRUE(state);
    EXPECT_LE(state->time, Now());
    EXPECT_GE(state->time, now - milliseconds(1000));
    if (times.empty() || state->time > times.back() + milliseconds(1)) times.push_back(state->time);
    std::this_thread::sleep_for(milliseconds(3));
  }
  // At five readings a second.
  EXPECT_GE(times.size(), 3u);
  EXPECT_LE(times.size(), 7u);
}

TEST_F(SerialTurntableTest, AReversedTableCountsTheOtherWay) {
  TinyController controller;
  SerialTurntableOptions options;
  options.reversed = true;
  options.limits = Travel{-20.0, 400.0};
  const auto table = TableAt(controller.path(), options);
  OpenAndHome(*table);
  Await(*table);
  ASSERT_TRUE(table->MoveTo(30.0, Now()));
  EXPECT_DOUBLE_EQ(Await(*table)->angle_deg, 30.0);
  EXPECT_THAT(controller.Heard(), HasSubstr("X-30.000"));
  const auto refused = table->MoveTo(-20.5, Now());
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().text, HasSubstr("limits_deg are -20 to 400"));
  EXPECT_EQ(refused.error().kind, ErrorKind::kDevice);
}

TEST_F(SerialTurntableTest, ALostPortIsAnErrorAndComesBackUnderAnotherName) {
  auto controller = std::make_unique<TinyController>("T");
  Plug(*controller);
  const auto table = TableAt(link_);
  OpenAndHome(*table);
  ASSERT_EQ(Await(*table)->motion, TableMotion::kIdle);
  controller->Unplug();
  ASSERT_TRUE(Soon([&] { return !table->State(Now()); }, 1000));
  EXPECT_THAT(table->State(Now()).error().text, HasSubstr("the port is gone"));
  EXPECT_FALSE(table->MoveTo(10.0, Now()));
  EXPECT_FALSE(table->Open(Now()));
  TinyController again("T");
  EXPECT_NE(again.path(), "");
  Plug(again);
  ASSERT_TRUE(Soon([&] { return table->Open(Now()).has_value(); }, 10000));
  const auto state = Await(*table);
  ASSERT_TRUE(state);
  EXPECT_EQ(state->motion, TableMotion::kUnhomed);
  EXPECT_FALSE(table->MoveTo(10.0, Now()));
  ASSERT_TRUE(table->Home(Now()));
  EXPECT_EQ(Await(*table)->motion, TableMotion::kIdle);
  EXPECT_TRUE(table->MoveTo(10.0, Now()));
}

TEST_F(SerialTurntableTest, AnotherControllerInItsPlaceIsRefused) {
  auto controller = std::make_unique<TinyController>("MINE");
  Plug(*controller);
  const auto table = TableAt(link_);
  ASSERT_TRUE(table->Open(Now()));
  controller->Unplug();
  TinyController other("YOURS");
  Plug(other);
  ASSERT_TRUE(Soon(
      [&] {
        const auto state = table->State(Now());
        return !state && state.error().text.find("another controller") != std::string::npos;
      },
      10000));
  EXPECT_THAT(table->Open(Now()).error().text,
              HasSubstr("YOURS, allowed is Grbl 1.1h.20190825 MINE"));
}

TEST_F(SerialTurntableTest, AControllerThatHangsIsAnError) {
  TinyController controller;
  const auto table = TableAt(controller.path());
  ASSERT_TRUE(table->Open(Now()));
  controller.Mute();
  ASSERT_TRUE(Soon([&] { return !table->State(Now()); }, 5000));
  EXPECT_THAT(table->State(Now()).error().text, HasSubstr("does not answer"));
}

TEST_F(SerialTurntableTest, TheSecondOnOnePortIsRefused) {
  TinyController controller;
  const auto table = TableAt(controller.path());
  ASSERT_TRUE(table->Open(Now()));
  const auto second = TableAt(controller.path())->Open(Now());
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().text, HasSubstr("in use by"));
}

TEST_F(SerialTurntableTest, WhatIsNotThereIsNamed) {
  EXPECT_THAT(TableAt(folder_ / "none")->Open(Now()).error().text,
              HasSubstr("none: No such file or directory; turnlight devices lists"));
  EXPECT_THAT(TableAt("/dev/null")->Open(Now()).error().text, HasSubstr("no serial port"));
  SerialTurntableOptions options;
  options.port.usb_serial = "NO SUCH";
  EXPECT_THAT(TableAt("", options)->Open(Now()).error().text,
              HasSubstr("no serial port with the USB serial number NO SUCH"));
  EXPECT_FALSE(TableAt("/dev/null")->State(Now()));  // not open
}

TEST_F(SerialTurntableTest, LeavesItsLampOff) {
  TinyController controller;
  grbl::GrblOptions lamp;
  lamp.lamp_power = 1.0;
  SerialTurntableOptions options;
  options.port.path = controller.path();
  {
    SerialTurntable table(options, std::make_unique<grbl::GrblProtocol>(lamp));
    ASSERT_TRUE(table.Open(Now()));
    ASSERT_TRUE(Soon([&] { return controller.Heard().find("M3 S1000") != std::string::npos; }));
  }
  EXPECT_TRUE(Soon([&] { return controller.Heard().find("M5") != std::string::npos; }));
}

}  // namespace
}  // namespace turnlight::rig::serial
