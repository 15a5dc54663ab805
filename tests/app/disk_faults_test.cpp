// Proves, with the whole program: killed after any one of its calls that change the disk, and with
// any one of them failing (no space, input/output error, a short write), a capture keeps what is
// safe, says what happened and how to go on, and ends after a resume with the bytes of a capture
// that nothing happened to. Does not prove it of a power cut: rig/capture's tests of the recorder
// are about the order of writes and syncs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>

#include "tests/app/program.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
using testing::AnyOf;
using testing::HasSubstr;

// Bytes by path, but for the one file that has times in it, and for the lock: the next program
// takes over what a killed one has left.
std::map<std::string, std::string> Files(const fs::path& session) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(session))
    if (entry.is_regular_file() && entry.path().filename() != "provenance.jsonl" &&
        entry.path().filename() != "capture.lock")
      files[fs::relative(entry.path(), session).string()] = ReadText(entry.path());
  return files;
}

std::size_t Lines(const fs::path& file) {
  const std::string text = ReadText(file);
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

class DiskFaults : public testing::Test {
 protected:
  void SetUp() override {
    config_ = folder_ / "small.yaml";
    WriteText(config_, SmallRunConfig());
    const Outcome outcome = Capture(folder_ / "whole", "", 0);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    whole_ = Files(fs::path(folder_ / "whole") / "session");
    ASSERT_EQ(whole_.count("session.json"), 1u);
  }

  Outcome Capture(const std::string& out, const std::string& what, int at) {
    return RunProgram({"capture", config_, "--out", out, "--threads", "1"},
                      {"LD_PRELOAD=" TURNLIGHT_DISK_SHIM, "DISK_SHIM_UNDER=" + out,
                       "DISK_SHIM_DO=" + what, "DISK_SHIM_AT=" + std::to_string(at)});
  }

  // Goes on after what happened at the call; what is there must become what was not disturbed.
  void ExpectRecovery(const std::string& out, const std::string& context) {
    Outcome outcome = RunProgram({"resume", out, "--threads", "1"});
    if (!fs::exists(fs::path(out) / "session/journal.jsonl")) {
      EXPECT_EQ(outcome.exit_code, 2) << context;
      EXPECT_THAT(outcome.err, HasSubstr("no capture was begun here")) << context;
      outcome = RunProgram({"capture", config_, "--out", out, "--threads", "1"});
    }
    EXPECT_EQ(outcome.exit_code, 0) << context << "\n" << outcome.err;
    EXPECT_TRUE(Files(fs::path(out) / "session") == whole_) << context;
  }

  // Disturbs one call after the other until there are no more; gives their number.
  int DisturbEachCall(const std::string& what) {
    for (int at = 1;; ++at) {
      const std::string out = folder_ / "disturbed";
      fs::remove_all(out);
      const Outcome outcome = Capture(out, what, at);
      const std::string context = what + " at call " + std::to_string(at) + ": " + outcome.err;
      const fs::path session = fs::path(out) / "session";
      const std::size_t journal = Lines(session / "journal.jsonl");
      if (outcome.exit_code == 0) {
        EXPECT_TRUE(Files(session) == whole_) << context;
        if (at > kMoreThanEnough) return at - 1;
        if (!Reached(out, what, at)) return at - 1;
        continue;
      }
      if (what != "kill") {
        EXPECT_THAT(outcome.err,
                    AnyOf(HasSubstr("No space left on device"), HasSubstr("Input/output error")))
            << context;
        // Line 1 says what was begun; without a frame it depends on how far the program was.
        EXPECT_THAT(outcome.exit_code, AnyOf(3, journal > 1 ? 3 : 2)) << context;
        if (journal > 0) {
          EXPECT_THAT(outcome.err, HasSubstr("turnlight resume")) << context;
        }
      }
      ExpectRecovery(out, context);
      if (HasFailure()) return at;
    }
  }

  // Whether a capture makes that many calls: it is killed at the call if it does.
  bool Reached(const std::string& out, const std::string& what, int at) {
    if (what == "short") return at <= 40;
    fs::remove_all(out);
    return Capture(out, "kill", at).exit_code == -1;
  }

  static constexpr int kMoreThanEnough = 400;
  TemporaryFolder folder_;
  std::string config_;
  std::map<std::string, std::string> whole_;
};

TEST_F(DiskFaults, KilledAfterAnyCallItResumes) { EXPECT_GT(DisturbEachCall("kill"), 60); }
TEST_F(DiskFaults, NoSpaceAtAnyCallItSaysSoAndResumes) {
  EXPECT_GT(DisturbEachCall("nospace"), 60);
}
TEST_F(DiskFaults, AnErrorAtAnyCallItSaysSoAndResumes) { EXPECT_GT(DisturbEachCall("error"), 60); }
TEST_F(DiskFaults, AShortWriteIsCompleted) { EXPECT_EQ(DisturbEachCall("short"), 40); }

}  // namespace
}  // namespace turnlight::app
