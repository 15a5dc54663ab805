// Proves of runs in real time: Ctrl-C once finishes the keyframe, twice and SIGTERM do not; a
// replay stops after the frame that is being written; each leaves a session that a resume completes
// to the bytes of a run that was left alone; a second program in the same folder is refused and
// told who is there. Does not prove how fast it stops.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <string>

#include "tests/app/program.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class RunSignals : public testing::Test {
 protected:
  // Real time; speed_deg_s of a table that has 120 degrees to go.
  std::string Config(const std::string& name, const std::string& speed_deg_s) {
    std::string text = SmallRunConfig();
    RunQuickly(text);
    Replace(text, "max_speed_deg_s: 1000", "max_speed_deg_s: " + speed_deg_s);
    Replace(text, "approach: one-sided",
            "approach: direct");  // the first keyframe is where it stands
    WriteText(folder_ / name, text);
    return folder_ / name;
  }
  // Waits until the journal has so many lines; the first says what was begun.
  static void Await(const std::string& out, std::size_t lines) {
    while (Lines(fs::path(out) / "session/journal.jsonl") < lines) ::usleep(2000);
  }
  void ExpectResumeCompletes(const std::string& config, const std::string& out) {
    const Outcome resumed = RunProgram({"resume", out});
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    const Outcome whole = RunProgram({"capture", config, "--out", folder_ / "whole"});
    EXPECT_EQ(whole.exit_code, 0) << whole.err;
    EXPECT_EQ(ContentOf(out + "/session"), ContentOf(folder_ / "whole/session"));
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

// The signal comes when the second frame of a replay is about to be written.
TEST_F(RunSignals, AReplayStopsAfterTheKeyframe) {
  WriteText(folder_ / "c.yaml", SmallRunConfig());
  const Outcome whole = RunProgram({"capture", folder_ / "c.yaml", "--out", folder_ / "whole"});
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  const std::string again = folder_ / "again";
  const Outcome stopped =
      RunProgram({"replay", folder_ / "whole/log", "--out", again},
                 {"LD_PRELOAD=" TURNLIGHT_DISK_SHIM, "DISK_SHIM_DO=interrupt", "DISK_SHIM_AT=1",
                  "DISK_SHIM_UNDER=" + again + "/session/frames/.001"});
  EXPECT_EQ(stopped.exit_code, 130);
  EXPECT_FALSE(fs::exists(again + "/session/session.json"));
  EXPECT_EQ(Lines(again + "/session/journal.jsonl"), 3u);
  EXPECT_THAT(stopped.err, HasSubstr("1 frame is missing"));
  EXPECT_THAT(stopped.err, HasSubstr("turnlight resume " + again));
  EXPECT_EQ(RunProgram({"resume", again}).exit_code, 0);
  EXPECT_EQ(ContentOf(again + "/session"), ContentOf(folder_ / "whole/session"));
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
