// Proves: whole files go in and out, a failed write leaves neither a temporary nor a changed file,
// and refusals name the file and the reason. Does not prove: that data survive a power cut (fsync
// is called; no test pulls the plug).
#include "base/file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>
#include <vector>

namespace turnlight {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

class File : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(testing::TempDir()) /
              ("turnlight_file_" + std::to_string(::getpid()) + info->name());
    fs::remove_all(folder_);
    fs::create_directory(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }

  fs::path folder_;
};

TEST_F(File, WritesReadsAndReplaces) {
  const std::string bytes("a\0b\xff\n", 5);
  ASSERT_TRUE(WriteFileAtomic(folder_ / "x", bytes));
  EXPECT_EQ(ReadFile(folder_ / "x").value(), bytes);
  ASSERT_TRUE(WriteFileAtomic(folder_ / "x", "short"));
  EXPECT_EQ(ReadFile(folder_ / "x").value(), "short");
  ASSERT_TRUE(WriteFileAtomic(folder_ / "x", ""));
  EXPECT_EQ(ReadFile(folder_ / "x").value(), "");
  EXPECT_THAT(Names(), ElementsAre("x"));
  struct stat info {};
  ASSERT_EQ(::stat((folder_ / "x").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777u, 0644u);
}

TEST_F(File, ReaderKeepsTheOldFile) {
  ASSERT_TRUE(WriteFileAtomic(folder_ / "x", "old"));
  fs::create_hard_link(folder_ / "x", folder_ / "held");
  ASSERT_TRUE(WriteFileAtomic(folder_ / "x", "new"));
  EXPECT_EQ(ReadFile(folder_ / "held").value(), "old");
}

TEST_F(File, FailedWriteLeavesNothing) {
  fs::create_directory(folder_ / "taken");
  const Status onto_folder = WriteFileAtomic(folder_ / "taken", "bytes");
  ASSERT_FALSE(onto_folder);
  EXPECT_EQ(onto_folder.error().kind, ErrorKind::kSystem);
  EXPECT_THAT(onto_folder.error().text, HasSubstr("taken: cannot rename into place"));
  EXPECT_THAT(Names(), ElementsAre("taken"));
  const Status nowhere = WriteFileAtomic(folder_ / "none" / "x", "bytes");
  ASSERT_FALSE(nowhere);
  EXPECT_THAT(nowhere.error().text, HasSubstr("none/x: cannot create"));
  EXPECT_THAT(Names(), ElementsAre("taken"));
}

TEST_F(File, ReadRefusals) {
  EXPECT_THAT(ReadFile(folder_ / "x").error().text, HasSubstr("x: cannot open: No such file"));
  EXPECT_THAT(ReadFile(folder_).error().text, HasSubstr("a folder, allowed is a file"));
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(ReadFile(folder_ / "pipe").error().text, HasSubstr("not a regular file"));
  ASSERT_TRUE(WriteFileAtomic(folder_ / "long", "12345"));
  EXPECT_TRUE(ReadFile(folder_ / "long", 5));
  const auto refused = ReadFile(folder_ / "long", 4);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kInput);
  EXPECT_THAT(refused.error().text, HasSubstr("long: 5 bytes, at most 4 are read"));
}

TEST_F(File, MakeDirectory) {
  EXPECT_TRUE(MakeDirectory(folder_ / "a" / "b"));
  EXPECT_TRUE(MakeDirectory(folder_ / "a" / "b"));
  EXPECT_TRUE(fs::is_directory(folder_ / "a" / "b"));
  ASSERT_TRUE(WriteFileAtomic(folder_ / "x", ""));
  EXPECT_FALSE(MakeDirectory(folder_ / "x"));
  EXPECT_FALSE(MakeDirectory(folder_ / "x" / "y"));
}

TEST_F(File, AppendsToWhatIsThere) {
  {
    auto file = AppendFile::Open(folder_ / "log");
    ASSERT_TRUE(file) << file.error().text;
    ASSERT_TRUE(file->Append("one\n"));
    AppendFile moved = std::move(*file);
    ASSERT_TRUE(moved.Append("two\n"));
  }
  auto again = AppendFile::Open(folder_ / "log");
  ASSERT_TRUE(again);
  ASSERT_TRUE(again->Append("three\n"));
  EXPECT_EQ(ReadFile(folder_ / "log").value(), "one\ntwo\nthree\n");
  EXPECT_FALSE(AppendFile::Open(folder_ / "none" / "log"));
}

// The second fsync of a file whose first one failed would succeed, and say nothing about the data.
class FailingSync : public FileOps {
 public:
  int Sync(int fd) override {
    if (++syncs != fail_at) return FileOps::Sync(fd);
    errno = EIO;
    return -1;
  }
  int fail_at = 0;
  int syncs = 0;
};

TEST_F(File, FailedSyncIsFinal) {
  FailingSync ops;
  auto file = AppendFile::Open(folder_ / "log", ops);
  ASSERT_TRUE(file);
  ops.fail_at = ops.syncs + 1;
  EXPECT_THAT(file->Append("one\n").error().text, HasSubstr("fsync failed: Input/output error"));
  EXPECT_THAT(file->Append("two\n").error().text, HasSubstr("not written to after an error"));
  EXPECT_EQ(ops.syncs, ops.fail_at);
  ops.fail_at = ops.syncs + 1;
  EXPECT_THAT(WriteFileAtomic(folder_ / "x", "bytes", ops).error().text, HasSubstr("fsync failed"));
  EXPECT_EQ(ops.syncs, ops.fail_at);
  EXPECT_THAT(Names(), ElementsAre("log"));
}

TEST_F(File, TemporariesAreKnownByTheirNames) {
  for (const char* name : {".x.a1B2c3", ".a.png.XXXXXX", ".session.json.000000"})
    EXPECT_TRUE(IsTemporaryName(name)) << name;
  for (const char* name :
       {"x.a1B2c3", ".x", ".abcdef", ".x.a1B2c", ".x.a1B2c-", "", ".", "..", ".x.a1B2c34"})
    EXPECT_FALSE(IsTemporaryName(name)) << name;
}

TEST_F(File, AMistypedPathIsToldTheNearestOne) {
  fs::create_directories(folder_ / "session");
  ASSERT_TRUE(WriteFileAtomic(folder_ / "session/rig.yaml", "x"));
  const auto told = [this](const std::string& typed) {
    const auto read = ReadTypedFile(folder_ / typed);
    return read ? *read : read.error().text;
  };
  EXPECT_EQ(told("session/rig.yaml"), "x");
  const std::string meant = "(did you mean \"" + (folder_ / "session/rig.yaml").string() + "\"?)";
  EXPECT_THAT(told("session/rgi.yaml"), HasSubstr(meant));
  EXPECT_THAT(told("sesion/rig.yaml"), HasSubstr(meant));
  // Two slips, or nothing near: no guess.
  EXPECT_THAT(told("sesion/rgi.yaml"), Not(HasSubstr("did you mean")));
  EXPECT_THAT(told("other/rig.yaml"), Not(HasSubstr("did you mean")));
  EXPECT_EQ(NearestPath(folder_ / "session"), "");
  EXPECT_EQ(NearestPath(""), "");
}

}  // namespace
}  // namespace turnlight
