// A lock that one process holds at a time, and that says who: a file with flock(2), which the
// system releases when the holder dies, however it dies.
#pragma once

#include <filesystem>
#include <string>

#include "base/file.h"
#include "base/result.h"

namespace turnlight {

class LockFile {
 public:
  // Creates the file and takes the lock, without waiting. Fails (kInput) if another holds it; the
  // message names its process, host and start. A file left by a dead holder is taken over.
  // what begins the message: "DIR: another capture is writing here".
  static Result<LockFile> Take(const std::filesystem::path& path, const std::string& what,
                               FileOps& ops = SystemFileOps());
  // The same among all users of this machine, root or not: name is that of a file in /run/lock, or
  // in /tmp where there is none. A file that another user left behind is taken over, and stays.
  static Result<LockFile> TakeForAll(const std::string& name, const std::string& what,
                                     FileOps& ops = SystemFileOps());
  ~LockFile();  // removes the file and releases
  LockFile(LockFile&& other) noexcept;
  LockFile& operator=(LockFile&& other) noexcept;

 private:
  using Opener = int (*)(const char* path, FileOps& ops);
  static Result<LockFile> TakeBy(Opener open, const std::filesystem::path& path,
                                 const std::string& what, FileOps& ops);
  LockFile(std::filesystem::path path, int fd, FileOps& ops)
      : path_(std::move(path)), fd_(fd), ops_(&ops) {}
  void Release();

  std::filesystem::path path_;
  int fd_ = -1;
  FileOps* ops_ = nullptr;
};

}  // namespace turnlight
