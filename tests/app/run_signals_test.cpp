// Proves of runs in real time: Ctrl-C once finishes the keyframe, twice and SIGTERM do not; each
// leaves a session that a resume completes to the bytes of a run that was left alone; a second
// program in the same folder is refused and told who is there. Does not prove how fast it stops.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <string>

#include "tests/app/program.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

std::size_t Lines(const fs::path& file) {
  const std::string text = ReadText(file);
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

class RunSignals : public testing::Test {
 protected:
  // Real time; speed_deg_s of a table that has 120 degrees to go.
  std::string Config(const std::string& name, const std::string& speed_deg_s) {
    std::string text = SmallRunConfig();
    for (const auto& [what, by] :
         {std::pair<std::string, std::string>{"executor: virtual", "executor: wall"},
          {"max_speed_deg_s: 30, acceleration_deg_s2: 120",
           "max_speed_deg_s: " + speed_deg_s + ", acceleration_deg_s2: 1000"}}) {
      const std::size_t at = text.find(what);
      EXPECT_NE(at, std::string::npos) << what;
      if (at != std::string::npos) text.replace(at, what.size(), by);
    }
    WriteText(folder_ / name, text);
    return folder_ / name;
  }
  // Waits until the journal has so many lines; the first says what was begun.
  static void Await(const std::string& out, std::size_t lines) {
    while (Lines(fs::path(out) / "session/journal.jsonl") < lines) ::usleep(2000);
  }
  std::string Content(const std::string& out) {
    const Outcome verified = RunProgram({"verify", out + "/session"});
    EXPECT_EQ(verified.exit_code, 0) << verified.out;
    const std::size_t at = verified.out.find("content sha256");
    return at == std::string::npos ? "" : verified.out.substr(at);
  }
  void ExpectResumeCompletes(const std::string& config, const std::string& out) {
    const Outcome resumed = RunProgram({"resume", out});
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    const Outcome whole = RunProgram({"capture", config, "--out", folder_ / "whole"});
    EXPECT_EQ(whole.exit_code, 0) << whole.err;
    EXPECT_EQ(Content(out), Content(folder_ / "whole"));
    EXPECT_EQ(ReadText(fs::path(out) / "session/journal.jsonl"),
              ReadText(fs::path(folder_ / "whole") / "session/journal.jsonl"));
  }

  TemporaryFolder folder_;
};

TEST_F(RunSignals, OnceFinishesTheKeyframeAndStops) {
  const std::string config = Config("fast.yaml", "200");
  const std::string out = folder_ / "out";
  const pid_t process = Start({"capture", config, "--out", out});
  Await(out, 2);  // the next keyframe has begun, or is about to
  ::kill(process, SIGINT);
  EXPECT_EQ(Finish(process), 130);
  const std::size_t lines = Lines(fs::path(out) / "session/journal.jsonl");
  EXPECT_GE(lines, 2u);
  EXPECT_LE(lines, 3u);
  EXPECT_FALSE(fs::exists(fs::path(out) / "session/session.json"));
  EXPECT_FALSE(fs::exists(fs::path(out) / "run.lock"));
  ExpectResumeCompletes(config, out);
}

// With a move that takes ten minutes the test would not end in time if it were waited for.
TEST_F(RunSignals, TwiceDoesNotWaitForTheTable) {
  const std::string out = folder_ / "out";
  const pid_t process = Start({"capture", Config("slow.yaml", "0.2"), "--out", out});
  Await(out, 2);
  ::kill(process, SIGINT);
  ::usleep(200'000);
  ::kill(process, SIGINT);
  EXPECT_EQ(Finish(process), 130);
  EXPECT_EQ(Lines(fs::path(out) / "session/journal.jsonl"), 2u);
}

TEST_F(RunSignals, TerminationDoesNotWaitForTheTable) {
  const std::string out = folder_ / "out";
  const pid_t process = Start({"capture", Config("slow.yaml", "0.2"), "--out", out});
  Await(out, 2);
  ::kill(process, SIGTERM);
  EXPECT_EQ(Finish(process), 130);
  EXPECT_EQ(Lines(fs::path(out) / "session/journal.jsonl"), 2u);
}

TEST_F(RunSignals, StoppedAtOnceItResumes) {
  const std::string config = Config("fast.yaml", "200");
  const std::string out = folder_ / "out";
  const pid_t process = Start({"capture", config, "--out", out});
  Await(out, 2);
  ::kill(process, SIGTERM);
  EXPECT_EQ(Finish(process), 130);
  ExpectResumeCompletes(config, out);
}

TEST_F(RunSignals, ASecondProgramInTheFolderIsRefusedAndToldWhoIsThere) {
  const std::string config = Config("slow.yaml", "0.2");
  const std::string out = folder_ / "out";
  const pid_t process = Start({"capture", config, "--out", out});
  Await(out, 1);
  for (const auto& arguments :
       {std::vector<std::string>{"run", config, "--out", out}, {"resume", out}}) {
    const Outcome second = RunProgram(arguments);
    EXPECT_EQ(second.exit_code, 2) << second.err;
    EXPECT_THAT(second.err,
                AllOf(HasSubstr(out + ": another run writes here"),
                      HasSubstr("process " + std::to_string(process) + " (turnlight)")));
  }
  ::kill(process, SIGTERM);
  EXPECT_EQ(Finish(process), 130);
}

}  // namespace
}  // namespace turnlight::app
