// Proves: whichever call to the disk a capture dies after, in the middle of, or sees fail, the
// frames that were called safe are safe, the error says what and where, and a resume ends with the
// same bytes as an undisturbed capture; and data are synced before the journal speaks of them. Does
// not prove: that a disk keeps what it has synced.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "tests/rig/capture/capture_fixture.h"

namespace turnlight::rig {
namespace {

using testing::AllOf;
using testing::HasSubstr;
namespace fs = std::filesystem;
using Fault = FaultyOps::Fault;

class RecorderFaults : public CaptureFixture {
 protected:
  void SetUp() override {
    const Status status = Capture(folder_.path() / "whole", counter_);
    ASSERT_TRUE(status) << status.error().text;
    whole_ = Contents(folder_.path() / "whole");
  }

  // Runs in a child that may die on the way. True if it did not.
  static bool Survives(const std::function<Status()>& run) {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(run() ? 0 : 1);
    int state = 0;
    EXPECT_EQ(::waitpid(child, &state, 0), child);
    EXPECT_TRUE(WIFEXITED(state));
    EXPECT_TRUE(WEXITSTATUS(state) == 0 || WEXITSTATUS(state) == 137) << WEXITSTATUS(state);
    return WEXITSTATUS(state) == 0;
  }

  // Frames of the journal with their files, and with a line of provenance.
  static std::size_t SafeFrames(const fs::path& root) {
    if (!fs::exists(root / kJournalFile)) return 0;
    const auto journal = ReadJournal(root);
    EXPECT_TRUE(journal);
    std::set<std::size_t> known;
    std::istringstream in(ReadFile(root / kProvenanceFile).value());
    for (std::string line; std::getline(in, line);) {
      const auto object = nlohmann::json::parse(line, nullptr, false);
      if (!object.is_discarded() && object["kind"] == "keyframe")
        known.insert(object["index"].get<std::size_t>());
    }
    std::size_t safe = 0;
    for (const JournalEntry& entry : journal->entries) {
      EXPECT_TRUE(known.contains(entry.index));
      safe += EntryProblems(root, entry).empty() ? 1 : 0;
    }
    EXPECT_EQ(safe, journal->entries.size());
    return safe;
  }

  // No picture under its final name that is not whole.
  void ExpectNoPartialPicture(const fs::path& root) {
    for (const auto& [name, bytes] : Contents(root)) {
      if (!name.starts_with("frames/") || IsTemporaryName(fs::path(name).filename().string()))
        continue;
      EXPECT_EQ(bytes, whole_.at(name)) << name;
    }
  }

  void ExpectResumeCompletes(const fs::path& root) {
    const Status status = Capture(root);
    ASSERT_TRUE(status) << status.error().text;
    EXPECT_EQ(Contents(root), whole_);
  }

  FaultyOps counter_;
  std::map<std::string, std::string> whole_;
};

TEST_F(RecorderFaults, KilledAfterEveryStep) {
  int at = 1;
  for (;; ++at) {
    const fs::path root = folder_.path() / std::to_string(at);
    FaultyOps ops(Fault::kCrash, at);
    const bool survived = Survives([&] { return Capture(root, ops); });
    if (survived) break;
    SCOPED_TRACE("after call " + std::to_string(at));
    if (fs::exists(root)) ExpectNoPartialPicture(root);
    if (fs::exists(root)) SafeFrames(root);
    ExpectResumeCompletes(root);
    fs::remove_all(root);
    if (HasFailure()) return;
  }
  EXPECT_EQ(at, counter_.calls() + 1);
  RecordProperty("steps", at - 1);
}

TEST_F(RecorderFaults, KilledInTheMiddleOfEveryWrite) {
  int deaths = 0;
  for (int at = 1; at <= counter_.calls(); ++at) {
    const fs::path root = folder_.path() / std::to_string(at);
    FaultyOps ops(Fault::kCrashInside, at);
    if (!Survives([&] { return Capture(root, ops); })) ++deaths;
    SCOPED_TRACE("in call " + std::to_string(at));
    ExpectResumeCompletes(root);
    fs::remove_all(root);
    if (HasFailure()) return;
  }
  EXPECT_GT(deaths, 20);
}

TEST_F(RecorderFaults, KilledAgainAfterEveryStepOfTheResume) {
  const fs::path begun = folder_.path() / "begun";
  FaultyOps first(Fault::kCrash, counter_.calls() / 2);
  ASSERT_FALSE(Survives([&] { return Capture(begun, first); }));
  // A torn line, so that the journal is written anew.
  std::ofstream(begun / kJournalFile, std::ios::app) << "{\"crc32\":\"01";
  for (int at = 1;; ++at) {
    const fs::path root = folder_.path() / std::to_string(at);
    fs::copy(begun, root, fs::copy_options::recursive);
    FaultyOps ops(Fault::kCrash, at);
    if (Survives([&] { return Capture(root, ops); })) {
      EXPECT_GT(at, 50);
      break;
    }
    SCOPED_TRACE("after call " + std::to_string(at));
    ExpectResumeCompletes(root);
    fs::remove_all(root);
    if (HasFailure()) return;
  }
}

class FailingCalls : public RecorderFaults, public testing::WithParamInterface<Fault> {};

TEST_P(FailingCalls, ErrorIsToldFramesAreKeptResumeCompletes) {
  const std::set<std::string> harmless{"close", "unlink"};  // of clean-ups, whose result is unused
  int errors = 0;
  for (int at = 1; at <= counter_.calls(); ++at) {
    const fs::path root = folder_.path() / std::to_string(at);
    SCOPED_TRACE("call " + std::to_string(at));
    FaultyOps ops(GetParam(), at);
    ops.free_bytes = 123456789;
    std::size_t added = 0;
    const Status status = Capture(root, ops, &added);
    if (status) {
      EXPECT_TRUE(ops.failed().empty() || harmless.contains(ops.failed())) << ops.failed();
      if (ops.failed() != "unlink") {
        EXPECT_EQ(Contents(root), whole_);
      }
    } else {
      ++errors;
      EXPECT_EQ(status.error().kind, ErrorKind::kSystem);
      EXPECT_THAT(status.error().text,
                  AllOf(HasSubstr(root.string()),
                        HasSubstr(GetParam() == Fault::kError ? "Input/output error"
                                                              : "No space left on device"),
                        HasSubstr("123456789 bytes are free"),
                        HasSubstr(std::to_string(added) + " of 4 frames are safe")));
      if (fs::exists(root)) {
        ExpectNoPartialPicture(root);
        EXPECT_GE(SafeFrames(root), added);
      }
      EXPECT_FALSE(fs::exists(root / "session.json") && ops.failed() != "sync" &&
                   ops.failed() != "open");
    }
    ExpectResumeCompletes(root);
    fs::remove_all(root);
    if (HasFailure()) return;
  }
  EXPECT_GT(errors, counter_.calls() / 2);
}

INSTANTIATE_TEST_SUITE_P(Faults, FailingCalls, testing::Values(Fault::kError, Fault::kNoSpace));

TEST_F(RecorderFaults, ShortWritesAreNoErrors) {
  for (int at = 1; at <= counter_.calls(); ++at) {
    const fs::path root = folder_.path() / std::to_string(at);
    FaultyOps ops(Fault::kShortWrite, at);
    const Status status = Capture(root, ops);
    ASSERT_TRUE(status) << status.error().text;
    EXPECT_EQ(Contents(root), whole_) << at;
    fs::remove_all(root);
  }
}

TEST_F(RecorderFaults, AfterAFailureNothingSucceeds) {
  const fs::path root = folder_.path() / "s";
  std::size_t sync = 0;  // of the second picture
  for (std::size_t i = 0; i < counter_.trace.size(); ++i)
    if (counter_.trace[i].starts_with("sync") &&
        counter_.trace[i].find(".001.exr.") != std::string::npos)
      sync = i;
  ASSERT_GT(sync, 0u);
  FaultyOps ops(Fault::kError, static_cast<int>(sync) + 1);
  auto recorder = SessionRecorder::Start(root, setup_, Run(), ops);
  ASSERT_TRUE(recorder && recorder->Add(keyframes_[0]));
  const Status failed = recorder->Add(keyframes_[1]);
  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error().text, AllOf(HasSubstr("001.exr: fsync failed: Input/output error")));
  const int calls = ops.calls();
  for (const std::size_t i : {1u, 2u}) {
    const Status again = recorder->Add(keyframes_[i]);
    ASSERT_FALSE(again);
    EXPECT_EQ(again.error().text, failed.error().text);
  }
  EXPECT_EQ(recorder->Finish().error().text, failed.error().text);
  EXPECT_EQ(ops.calls(), calls);  // not even tried
  EXPECT_EQ(recorder->entries().size(), 1u);
}

// In the trace of calls: a picture is synced after its last write and before it gets its name, the
// folder after that, and only then the journal grows.
TEST_F(RecorderFaults, SyncsComeBeforeTheJournal) {
  std::set<std::string> unsynced;
  std::size_t renames = 0;
  std::size_t lines = 0;
  for (const std::string& step : counter_.trace) {
    const std::size_t space = step.find(' ');
    const std::string call = step.substr(0, space);
    const fs::path path = step.substr(space + 1);
    if (path.filename() == "capture.lock") continue;
    if (call == "write" && path.filename() == kJournalFile) {
      EXPECT_TRUE(unsynced.empty()) << *unsynced.begin();
      ++lines;
    }
    if (call == "write") unsynced.insert(path.string());
    if (call == "sync") unsynced.erase(path.string());
    if (call == "rename") {
      for (const std::string& name : unsynced)
        EXPECT_NE(fs::path(name).parent_path(), path.parent_path());
      unsynced.insert(path.parent_path().string());
      ++renames;
    }
    if (call == "mkdir") unsynced.insert(path.parent_path().string());
  }
  EXPECT_TRUE(unsynced.empty());
  EXPECT_EQ(lines, 4u);
  EXPECT_EQ(renames, 8u + 5u);  // pictures and maps; camera twice, mesh, journal, session
}

}  // namespace
}  // namespace turnlight::rig
