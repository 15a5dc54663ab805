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
  ~LockFile();  // removes the file and releases
  LockFile(LockFile&& other) noexcept;
  LockFile& operator=(LockFile&& other) noexcept;

 private:
  LockFile(std::filesystem::path path, int fd, FileOps& ops)
      : path_(std::move(path)), fd_(fd), ops_(&ops) {}
  void Release();

  std::filesystem::path path_;
  int fd_ = -1;
  FileOps* ops_ = nullptr;
};

}  // namespace turnlight
