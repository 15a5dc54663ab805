// Proves, with the whole program: killed after any one of its calls that change the disk, and with
// any one of them failing (no space, input/output error, a short write), a capture keeps what is
// safe, says what happened and how to go on, and ends after a resume with the bytes of a capture
// that nothing happened to. Does not prove it of a power cut: rig/capture's tests of the recorder
// are about the order of writes and syncs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "base/file.h"
#include "tests/app/program.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

using FileMap = std::map<std::string, std::string>;

// Bytes by path, but for the one file that has times in it, and for the lock: the next program
// takes over what a killed one has left.
FileMap Files(const fs::path& session) {
  FileMap files;
  for (const auto& entry : fs::recursive_directory_iterator(session))
    if (entry.is_regular_file() && entry.path().filename() != "provenance.jsonl" &&
        entry.path().filename() != "capture.lock")
      files[fs::relative(entry.path(), session).string()] = ReadText(entry.path());
  return files;
}

// All that a resume may look at. Of what differs from time to time only what matters: how many
// lines the provenance has and whether the last one is torn, that a temporary or a lock is there.
FileMap StateOf(const fs::path& run) {
  FileMap state;
  if (!fs::exists(run)) return state;
  for (const auto& entry : fs::recursive_directory_iterator(run)) {
    std::string name = fs::relative(entry.path(), run).string();
    std::string text = entry.is_regular_file() ? ReadText(entry.path()) : "";
    if (IsTemporaryName(entry.path().filename().string())) name.resize(name.size() - 6);
    if (entry.path().extension() == ".lock") text.clear();
    if (entry.path().filename() == "provenance.jsonl")
      text = std::to_string(Count(text, "\n")) + (text.ends_with('\n') ? "" : " torn");
    state[name] = text;
  }
  return state;
}

class DiskFaults : public testing::Test {
 protected:
  void SetUp() override {
    config_ = folder_ / "small.yaml";
    std::string text = SmallRunConfig();
    Replace(text, "count: 3", "count: 2");
    Replace(text, "samples_per_side: 4", "samples_per_side: 1");
    WriteText(config_, text);
    const Outcome outcome = Capture(folder_ / "whole", "", 0);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    whole_ = Files(folder_ / "whole/session");
    ASSERT_EQ(whole_.count("session.json"), 1u);
  }

  Outcome Capture(const std::string& out, const std::string& what, int at) {
    fs::remove(mark_);
    return RunProgram(
        {"capture", config_, "--out", out, "--threads", "1"},
        {"LD_PRELOAD=" TURNLIGHT_DISK_SHIM, "DISK_SHIM_UNDER=" + out, "DISK_SHIM_DO=" + what,
         "DISK_SHIM_AT=" + std::to_string(at), "DISK_SHIM_MARK=" + mark_});
  }

  // Goes on after what happened at the call; what is there must become what was not disturbed. Not
  // again from a state from which it was seen already.
  void ExpectRecovery(const std::string& out, const std::string& context) {
    if (!recovered_.insert(StateOf(out)).second) return;
    Outcome outcome = RunProgram({"resume", out, "--threads", "1"});
    if (!fs::exists(fs::path(out) / "session/journal.jsonl")) {
      EXPECT_EQ(outcome.exit_code, 2) << context;
      EXPECT_THAT(outcome.err, HasSubstr("no capture was begun here")) << context;
      outcome = RunProgram({"capture", config_, "--out", out, "--threads", "1"});
    }
    EXPECT_EQ(outcome.exit_code, 0) << context << "\n" << outcome.err;
    EXPECT_TRUE(Files(fs::path(out) / "session") == whole_) << context;
  }

  void ExpectItSaysSo(const Outcome& outcome, const std::string& out, const std::string& context) {
    const std::size_t journal = Lines(fs::path(out) / "session/journal.jsonl");
    EXPECT_THAT(outcome.err,
                AnyOf(HasSubstr("No space left on device"), HasSubstr("Input/output error")))
        << context;
    // Line 1 says what was begun; without a frame it depends on how far the program was.
    EXPECT_THAT(outcome.exit_code, AnyOf(3, journal > 1 ? 3 : 2)) << context;
    if (journal > 0) {
      EXPECT_THAT(outcome.err, HasSubstr("turnlight resume")) << context;
    } else {  // there is nothing that could be gone on with
      EXPECT_THAT(outcome.err, Not(HasSubstr("resume"))) << context;
    }
  }

  // Disturbs one call after the other until a capture makes no more of them; gives their number.
  int DisturbEachCall(const std::string& what) {
    for (int at = 1;; ++at) {
      const std::string out = folder_ / "disturbed";
      fs::remove_all(out);
      const Outcome outcome = Capture(out, what, at);
      const std::string call = ReadText(mark_);
      const std::string context =
          what + " at call " + std::to_string(at) + ", " + call + ": " + outcome.err;
      if (call.empty() || what == "short") {
        EXPECT_EQ(outcome.exit_code, 0) << context;
        EXPECT_TRUE(Files(fs::path(out) / "session") == whole_) << context;
        if (call.empty()) return at - 1;
      } else if (what == "kill") {
        EXPECT_EQ(outcome.exit_code, -1) << context;
        ExpectRecovery(out, context);
      } else if (outcome.exit_code == 0) {
        EXPECT_EQ(call, "unlink") << context;  // only a lock that nobody holds may stay behind
        EXPECT_TRUE(Files(fs::path(out) / "session") == whole_) << context;
      } else {
        ExpectItSaysSo(outcome, out, context);
        ExpectRecovery(out, context);
      }
      if (HasFailure()) return at;
    }
  }

  TemporaryFolder folder_;
  std::string config_, mark_ = folder_ / "mark";
  FileMap whole_;
  std::set<FileMap> recovered_;
};

TEST_F(DiskFaults, KilledAfterAnyCallItResumes) { EXPECT_GT(DisturbEachCall("kill"), 80); }
TEST_F(DiskFaults, NoSpaceAtAnyCallItSaysSoAndResumes) {
  EXPECT_GT(DisturbEachCall("nospace"), 80);
}
TEST_F(DiskFaults, AnErrorAtAnyCallItSaysSoAndResumes) { EXPECT_GT(DisturbEachCall("error"), 80); }
TEST_F(DiskFaults, AShortWriteIsCompleted) { EXPECT_GT(DisturbEachCall("short"), 15); }

}  // namespace
}  // namespace turnlight::app
