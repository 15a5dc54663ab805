#include "base/lock_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "base/utc.h"

namespace turnlight {
namespace {

// "process 1234 (turnlight) on host lab3 since 2024-05-01T12:00:00.123Z"
std::string DescribeThisProcess() {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  return "process " + std::to_string(::getpid()) + " (" + program_invocation_short_name +
         ") on host " + host.data() + " since " + UtcNow();
}

constexpr int kOpenFlags = O_RDWR | O_CLOEXEC | O_NOFOLLOW;

int OpenOwn(const char* path, FileOps& ops) { return ops.Open(path, kOpenFlags | O_CREAT, 0644); }

// Writable by everyone, whatever the umask. Another user's file in a folder like /tmp may not be
// opened with O_CREAT, even by root (fs.protected_regular).
int OpenForAll(const char* path, FileOps& ops) {
  const int fd = ops.Open(path, kOpenFlags | O_CREAT, 0666);
  if (fd < 0) return errno == EACCES ? ops.Open(path, kOpenFlags, 0) : fd;
  ops.ChangeMode(fd, 0666);  // fails on a file of another user that is open to all already
  return fd;
}

// The lock counts only on the file that the path names: another process may have removed it between
// our opening and locking it.
bool IsTheFileAt(int fd, const std::filesystem::path& path) {
  struct stat held {};
  struct stat named {};
  return ::fstat(fd, &held) == 0 && ::stat(path.c_str(), &named) == 0 &&
         held.st_dev == named.st_dev && held.st_ino == named.st_ino;
}

Status WriteHolder(int fd, const std::filesystem::path& path, FileOps& ops) {
  if (ops.Truncate(fd, 0) == 0 && WriteAll(fd, DescribeThisProcess() + "\n", ops)) return {};
  return SystemError(path.string() + ": cannot write the lock: " + std::strerror(errno));
}

std::string ReadHolder(const std::filesystem::path& path) {
  std::string holder = ReadFile(path, 4096).value_or("");
  holder = holder.substr(0, holder.find('\n'));
  return holder.empty() ? "a process that has not written its name yet" : holder;
}

}  // namespace

Result<LockFile> LockFile::Take(const std::filesystem::path& path, const std::string& what,
                                FileOps& ops) {
  return TakeBy(OpenOwn, path, what, ops);
}

Result<LockFile> LockFile::TakeForAll(const std::string& name, const std::string& what,
                                      FileOps& ops) {
  struct stat run {};
  const bool has_run =
      ::stat("/run/lock", &run) == 0 && S_ISDIR(run.st_mode) && (run.st_mode & S_IWOTH) != 0;
  return TakeBy(OpenForAll, std::filesystem::path(has_run ? "/run/lock" : "/tmp") / name, what,
                ops);
}

Result<LockFile> LockFile::TakeBy(Opener open, const std::filesystem::path& path,
                                  const std::string& what, FileOps& ops) {
  while (true) {
    const int fd = open(path.c_str(), ops);
    if (fd < 0) return SystemError(path.string() + ": cannot open: " + std::strerror(errno));
    if (ops.Lock(fd) != 0) {
      const int reason = errno;
      ops.Close(fd);
      if (reason == EWOULDBLOCK) return InputError(what + ": " + ReadHolder(path));
      return SystemError(path.string() + ": cannot lock: " + std::strerror(reason));
    }
    if (!IsTheFileAt(fd, path)) {
      ops.Close(fd);
      continue;
    }
    LockFile lock(path, fd, ops);
    if (const Status status = WriteHolder(fd, path, ops); !status) return Forward(status);
    return lock;
  }
}

LockFile::~LockFile() { Release(); }

LockFile::LockFile(LockFile&& other) noexcept
    : path_(std::move(other.path_)), fd_(std::exchange(other.fd_, -1)), ops_(other.ops_) {}

LockFile& LockFile::operator=(LockFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(fd_, other.fd_);
  std::swap(ops_, other.ops_);
  return *this;
}

void LockFile::Release() {
  if (fd_ < 0) return;
  ops_->Unlink(path_.c_str());  // while held: whoever waits for it sees that it is gone
  ops_->Close(std::exchange(fd_, -1));
}

}  // namespace turnlight
