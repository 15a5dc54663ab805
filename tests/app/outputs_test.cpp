// Proves with the real program: a terminal that is closed, and a pipe whose reader ends, stop a
// motion and a capture in order, with exit code 130, no lock left and a session that can be gone
// on with; nohup outlives its terminal; a result that could not be printed is noticed, is on disk
// all the same, and has the exit code that is written down. Does not prove that a motor stands: the
// tests of the loop ask the controller.
#include "app/outputs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/app/listener.h"
#include "tests/app/program.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

class Outputs : public testing::Test {
 protected:
  // A table that takes its time, in real time.
  std::string Config(const std::string& name, const std::string& speed_deg_s) {
    std::string text = SmallRunConfig();
    RunQuickly(text);
    Replace(text, "max_speed_deg_s: 1000", "max_speed_deg_s: " + speed_deg_s);
    Replace(text, "approach: one-sided", "approach: direct");
    WriteText(folder_ / name, text);
    return folder_ / name;
  }
  // Runs "turnlight ARGUMENTS" by a shell; its exit code.
  int Shell(const std::string& arguments) {
    const int status = std::system(("exec '" TURNLIGHT_PROGRAM "' " + arguments).c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string Session() {
    WriteSession(SmallConfig(), folder_ / "session");
    return folder_ / "session";
  }

  TemporaryFolder folder_;
};

TEST_F(Outputs, WhoeverLeavesStopsAMotion) {
  const std::string config = Config("slow.yaml", "20");
  for (const Line line :
       {Line::kTerminal, Line::kForeignTerminal, Line::kPipe, Line::kPipeOfErrors}) {
    Listener listener(line, {"jog", config, "3600"});
    EXPECT_TRUE(listener.Hears("will turn")) << static_cast<int>(line);
    listener.Leave();
    EXPECT_EQ(listener.Finish(), 130) << static_cast<int>(line);
  }
  // Nothing is said on standard output before the end.
  Listener listener(Line::kPipeOfOutput, {"jog", config, "3600"});
  listener.Leave();
  EXPECT_EQ(listener.Finish(), 130);
}

TEST_F(Outputs, WhoeverLeavesStopsACaptureInOrder) {
  const std::string config = Config("slow.yaml", "0.2");
  for (const Line line : {Line::kTerminal, Line::kForeignTerminal, Line::kPipe}) {
    const std::string out = folder_ / ("out" + std::to_string(static_cast<int>(line)));
    Listener listener(line, {"capture", config, "--out", out});
    EXPECT_TRUE(listener.Hears("frame 1/3"));
    while (Lines(fs::path(out) / "session/journal.jsonl") < 2) ::usleep(2000);
    listener.Leave();
    EXPECT_EQ(listener.Finish(), 130);
    EXPECT_EQ(Lines(fs::path(out) / "session/journal.jsonl"), 2u);
    EXPECT_FALSE(fs::exists(fs::path(out) / "run.lock"));
    EXPECT_FALSE(fs::exists(fs::path(out) / "session/capture.lock"));
  }
}

TEST_F(Outputs, UnderNohupItOutlivesItsTerminal) {
  const std::string out = folder_ / "out";
  for (const Line line : {Line::kTerminal, Line::kForeignTerminal}) {
    fs::remove_all(out);
    Listener listener(line, {"capture", Config("fast.yaml", "300"), "--out", out},
                      Hangup::kIgnored);
    EXPECT_TRUE(listener.Hears("frame 1/3"));
    listener.Leave();
    // The frames are all there; what its last line was to say has nobody read.
    EXPECT_EQ(listener.Finish(), 2);
    EXPECT_TRUE(fs::exists(out + "/session/session.json"));
  }
}

TEST_F(Outputs, AnEstimateEndsWithItsTerminal) {
  const std::string session = Session();
  Listener listener(Line::kTerminal, {"estimate", session, "--out", folder_ / "result"});
  EXPECT_TRUE(listener.Hears("reading"));
  listener.Leave();
  EXPECT_EQ(listener.Finish(), 130);
  EXPECT_FALSE(fs::exists(folder_ / "result/result.json"));
}

TEST_F(Outputs, AResultThatCouldNotBePrintedIsNoticed) {
  const std::string session = Session();
  const std::string estimate = "estimate " + session + " --no-pictures --out ";
  ASSERT_EQ(Shell(estimate + (folder_ / "good") + " > /dev/null"), 0);
  EXPECT_EQ(Shell(estimate + (folder_ / "full") + " --json > /dev/full 2> " + (folder_ / "err")),
            2);
  EXPECT_THAT(ReadText(folder_ / "err"), HasSubstr("standard output: No space left on device"));
  EXPECT_EQ(Shell(estimate + (folder_ / "closed") + " >&- 2> " + (folder_ / "err")), 2);
  EXPECT_THAT(ReadText(folder_ / "err"), HasSubstr("standard output: it is closed"));
  EXPECT_EQ(Shell(estimate + (folder_ / "none") + " >&- 2>&- <&-"), 2);
  for (const char* result : {"full", "closed", "none"})
    EXPECT_EQ(ResultWithoutTimes(folder_ / result), ResultWithoutTimes(folder_ / "good"));
  EXPECT_EQ(Shell("--help > /dev/full 2> /dev/null"), 2);
}

TEST_F(Outputs, AReaderThatHasEnoughIsNoFault) {
  const std::string err = folder_ / "err";
  // The reader has ended before the program begins.
  const std::string bash = "bash -c '(sleep 0.3; exec " TURNLIGHT_PROGRAM " --help 2> " + err +
                           "; ) | true; exit ${PIPESTATUS[0]}'";
  const int status = std::system(bash.c_str());
  EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : -1, 141);
  EXPECT_THAT(ReadText(err), IsEmpty());
}

}  // namespace
}  // namespace turnlight::app
