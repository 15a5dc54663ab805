// Proves: one holder at a time, named to the others, also between processes; a dead holder's lock
// is free; the file is gone afterwards. Does not prove: locks of network file systems.
#include "base/lock_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <utility>

namespace turnlight {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::MatchesRegex;
namespace fs = std::filesystem;

class LockFileTest : public testing::Test {
 protected:
  void TearDown() override { fs::remove(path_); }
  Result<LockFile> Take() { return LockFile::Take(path_, "port: in use"); }

  const fs::path path_ = fs::path(testing::TempDir()) / ("lock." + std::to_string(::getpid()));
};

TEST_F(LockFileTest, OneHolderAndItsName) {
  {
    auto lock = Take();
    ASSERT_TRUE(lock) << lock.error().text;
    const auto second = Take();
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().kind, ErrorKind::kInput);
    EXPECT_THAT(second.error().text,
                AllOf(HasSubstr("port: in use: process " + std::to_string(::getpid()) + " ("),
                      MatchesRegex(".* since 20..-..-..T..:..:..[.]...Z")));
    const LockFile moved = std::move(*lock);
    EXPECT_FALSE(Take());
  }
  EXPECT_FALSE(fs::exists(path_));
  EXPECT_TRUE(Take());
}

TEST_F(LockFileTest, HeldByAnotherProcessUntilItDies) {
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const auto lock = Take();
    const char byte = lock ? 'y' : 'n';
    if (::write(ready[1], &byte, 1) != 1) ::_exit(1);
    ::pause();
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  ASSERT_EQ(byte, 'y');
  const auto refused = Take();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().text, HasSubstr("process " + std::to_string(child) + " ("));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_TRUE(fs::exists(path_));
  EXPECT_TRUE(Take());
}

// An ordinary user (here the child, if this runs as root) and its file, which root takes over.
TEST_F(LockFileTest, ForAllUsersOfTheMachine) {
  const std::string name = "turnlight_test." + std::to_string(::getpid()) + ".lock";
  const pid_t child = ::fork();
  if (child == 0) {
    if (::getuid() == 0 && ::setuid(65534) != 0) ::_exit(2);
    ::umask(077);
    const auto lock = LockFile::TakeForAll(name, "port: in use");
    ::_exit(lock ? 0 : 1);  // without removing the file
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_EQ(status, 0);
  const auto lock = LockFile::TakeForAll(name, "port: in use");
  ASSERT_TRUE(lock) << lock.error().text;
  const auto second = LockFile::TakeForAll(name, "port: in use");
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().text,
              HasSubstr("port: in use: process " + std::to_string(::getpid()) + " ("));
}

TEST_F(LockFileTest, NowhereToPutIt) {
  const auto lock = LockFile::Take("/nowhere/lock", "x");
  ASSERT_FALSE(lock);
  EXPECT_EQ(lock.error().kind, ErrorKind::kSystem);
  EXPECT_THAT(lock.error().text, HasSubstr("/nowhere/lock: cannot open: No such file"));
}

}  // namespace
}  // namespace turnlight
