#include "base/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

namespace turnlight {
namespace {

std::string ErrnoText() { return std::strerror(errno); }

// Owns a file descriptor.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  int release() { return std::exchange(fd_, -1); }

 private:
  int fd_;
};

Status WriteAll(int fd, std::string_view bytes, const std::filesystem::path& path) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0) {
      if (errno == EINTR) continue;
      return SystemError(path.string() + ": cannot write: " + ErrnoText());
    }
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  if (::fsync(fd) != 0) return SystemError(path.string() + ": fsync failed: " + ErrnoText());
  return {};
}

Status SyncDirectory(const std::filesystem::path& directory) {
  const Descriptor fd(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.get() < 0 || ::fsync(fd.get()) != 0)
    return SystemError(directory.string() + ": cannot sync the folder: " + ErrnoText());
  return {};
}

}  // namespace

Result<std::string> ReadFile(const std::filesystem::path& path, std::uint64_t max_bytes) {
  const Descriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (fd.get() < 0) return InputError(path.string() + ": cannot open: " + ErrnoText());
  struct stat info {};
  if (::fstat(fd.get(), &info) != 0)
    return InputError(path.string() + ": cannot read: " + ErrnoText());
  if (!S_ISREG(info.st_mode)) return InputError(path.string() + ": not a regular file");
  if (static_cast<std::uint64_t>(info.st_size) > max_bytes)
    return InputError(path.string() + ": " + std::to_string(info.st_size) + " bytes, at most " +
                      std::to_string(max_bytes) + " are read");
  std::string bytes(static_cast<std::size_t>(info.st_size), '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = ::read(fd.get(), bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return InputError(path.string() + ": cannot read: " + ErrnoText());
    if (n == 0) break;
    done += static_cast<std::size_t>(n);
  }
  bytes.resize(done);
  return bytes;
}

Status WriteFileAtomic(const std::filesystem::path& path, std::string_view bytes) {
  const std::filesystem::path directory =
      path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  std::string temporary = (directory / ("." + path.filename().string() + ".XXXXXX")).string();
  Descriptor fd(::mkstemp(temporary.data()));
  if (fd.get() < 0) return SystemError(path.string() + ": cannot create: " + ErrnoText());
  Status status = WriteAll(fd.get(), bytes, path);
  if (status && ::fchmod(fd.get(), 0644) != 0)
    status = SystemError(path.string() + ": cannot set its mode: " + ErrnoText());
  if (::close(fd.release()) != 0 && status)
    status = SystemError(path.string() + ": cannot close: " + ErrnoText());
  if (status && ::rename(temporary.c_str(), path.c_str()) != 0)
    status = SystemError(path.string() + ": cannot rename into place: " + ErrnoText());
  if (!status) {
    ::unlink(temporary.c_str());
    return status;
  }
  return SyncDirectory(directory);
}

Status MakeDirectory(const std::filesystem::path& path) {
  std::error_code code;
  std::filesystem::create_directories(path, code);
  if (code) return SystemError(path.string() + ": cannot create the folder: " + code.message());
  return {};
}

}  // namespace turnlight
