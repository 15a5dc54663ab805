// Whole files in and out, and files that grow.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/result.h"

namespace turnlight {

// The system calls behind everything here that changes a disk, one by one: a test overrides some to
// let the n-th fail, or to end the process after it. Each returns what its system call returns,
// with errno set. The base class calls the system.
class FileOps {
 public:
  virtual ~FileOps() = default;
  virtual int Open(const char* path, int flags, mode_t mode);
  virtual int MakeTemporary(char* name);  // mkstemp: the last 6 characters are replaced
  virtual ssize_t Write(int fd, const void* data, std::size_t size);
  virtual int Truncate(int fd, off_t size);
  virtual int ChangeMode(int fd, mode_t mode);
  virtual int Sync(int fd);
  virtual int Close(int fd);
  virtual int Lock(int fd);  // flock, exclusive, without waiting
  virtual int Rename(const char* from, const char* to);
  virtual int Unlink(const char* path);
  virtual int MakeFolder(const char* path);  // mkdir, mode 0755
  // Bytes that an ordinary user may still write there; -1 with errno.
  virtual std::int64_t FreeBytes(const char* path);
};
FileOps& SystemFileOps();

// Writes all of the bytes, going on after a short write or a signal. False with errno set.
bool WriteAll(int fd, std::string_view bytes, FileOps& ops = SystemFileOps());

// Reads a regular file. Fails (kInput) if it is missing, not a regular file, or larger than
// max_bytes.
Result<std::string> ReadFile(const std::filesystem::path& path,
                             std::uint64_t max_bytes = std::uint64_t{4} << 30);

// " (did you mean "configs/a.yaml"?)": of a path that is not there, the one that is and differs by
// a slip of the finger in one name; "" if there is none.
std::string NearestPath(const std::filesystem::path& path);
// ReadFile of a path that a person typed: the message of a missing one has NearestPath.
Result<std::string> ReadTypedFile(const std::filesystem::path& path,
                                  std::uint64_t max_bytes = std::uint64_t{4} << 30);

// Writes so that a reader sees the old file or the whole new one, also after a crash: temporary
// file beside it, write, fsync, rename, fsync of the directory. Fails (kSystem) and leaves no
// temporary.
Status WriteFileAtomic(const std::filesystem::path& path, std::string_view bytes,
                       FileOps& ops = SystemFileOps());

// Whether the name is one that WriteFileAtomic gives its temporaries, such as ".a.png.x7Kp2Q": what
// a killed process leaves behind.
bool IsTemporaryName(std::string_view name);

// Creates the directory and its parents, each synced; an existing directory is fine.
Status MakeDirectory(const std::filesystem::path& path, FileOps& ops = SystemFileOps());

// A file that only grows; what was appended is on the disk.
class AppendFile {
 public:
  // Creates the file if it is missing. ops outlives it.
  static Result<AppendFile> Open(const std::filesystem::path& path, FileOps& ops = SystemFileOps());
  ~AppendFile();
  AppendFile(AppendFile&& other) noexcept;
  AppendFile& operator=(AppendFile&& other) noexcept;

  // Write and fsync. After a failure part of the bytes may be there, and further calls fail.
  Status Append(std::string_view bytes);

 private:
  AppendFile(std::filesystem::path path, int fd, FileOps& ops)
      : path_(std::move(path)), fd_(fd), ops_(&ops) {}

  std::filesystem::path path_;
  int fd_ = -1;
  FileOps* ops_;
  bool failed_ = false;
};

}  // namespace turnlight
