// Proves: time, output, events and bad lines are kept as every protocol of lines needs it; a
// conversation that is over says nothing more.
#include "rig/serial/line_protocol.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace turnlight::rig::serial {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;

// Answers a line with itself; "?" is bad, "!" is the end.
class Echo : public LineProtocol {
 public:
  Echo() : LineProtocol(8) {}
  void Home() override {}
  void MoveTo(double) override {}
  void Halt() override {}
  int wakes = 0;

 private:
  void Begin() override {
    Write("hello\n");
    WakeIn(milliseconds(30));
  }
  void HandleLine(const std::string& line) override {
    if (line == "!") return Fail("the end", true);
    if (line.starts_with('?')) return BadLine(line);
    Write(line + "\n");
    Report(TableMotion::kIdle, 1.0, "", DeviceTime::zero());
  }
  void HandleTime() override { ++wakes; }
};

TEST(LineProtocol, IsSilentUntilItIsConnected) {
  Echo echo;
  echo.Receive("a\n");
  echo.Pass(seconds(100));
  EXPECT_EQ(echo.TakeOutput(), "");
  EXPECT_GT(echo.Until(), DeviceTime::zero());
  echo.Connect();
  echo.Receive("a\r\n\x11 b\x13\n");
  EXPECT_EQ(echo.TakeOutput(), "hello\na\n b\n");
  EXPECT_EQ(echo.TakeEvents().size(), 2u);
}

TEST(LineProtocol, WakesOnceWhenItsTimeIsOver) {
  Echo echo;
  echo.Connect();
  EXPECT_EQ(echo.Until(), milliseconds(30));
  echo.Pass(milliseconds(10));
  EXPECT_EQ(echo.Until(), milliseconds(20));
  EXPECT_EQ(echo.wakes, 0);
  echo.Pass(milliseconds(20));
  EXPECT_EQ(echo.wakes, 1);
  echo.Pass(milliseconds(100));
  EXPECT_EQ(echo.wakes, 1);
  echo.Receive("a\n");
  const auto events = echo.TakeEvents();
  EXPECT_EQ(std::get<StageReport>(events.at(0)).age, milliseconds(130));
}

TEST(LineProtocol, FiveBadLinesInAMinuteEndIt) {
  Echo echo;
  echo.Connect();
  for (int minute = 0; minute < 3; ++minute) {
    echo.Receive("?\nlonger than eight\nx\x01y\n?\n");
    EXPECT_TRUE(echo.TakeEvents().empty());
    echo.Pass(seconds(61));
  }
  echo.Receive("?\n?\n?\n?\n?what\na\n");
  const auto events = echo.TakeEvents();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_THAT(std::get<StageFailed>(events[0]).text, HasSubstr("5 lines"));
  EXPECT_THAT(std::get<StageFailed>(events[0]).text, HasSubstr("'?what'"));
  EXPECT_FALSE(std::get<StageFailed>(events[0]).for_good);
}

TEST(LineProtocol, SaysNothingAfterTheEnd) {
  Echo echo;
  echo.Connect();
  echo.TakeOutput();
  echo.Receive("!\na\n");
  EXPECT_EQ(echo.TakeOutput(), "");
  ASSERT_EQ(echo.TakeEvents().size(), 1u);
  echo.Receive("!\n?\n?\n?\n?\n?\n");
  echo.Pass(seconds(10));
  EXPECT_EQ(echo.wakes, 0);
  EXPECT_TRUE(echo.TakeEvents().empty());
  echo.Connect();
  EXPECT_EQ(echo.TakeOutput(), "hello\n");
}

}  // namespace
}  // namespace turnlight::rig::serial
