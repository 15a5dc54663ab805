#include "base/file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <utility>
#include <vector>

#include "base/nearest.h"

namespace turnlight {
namespace {

namespace fs = std::filesystem;

constexpr char kTemporaryEnd[] = ".XXXXXX";

std::string ErrnoText() { return std::strerror(errno); }

// Owns a file descriptor.
class Descriptor {
 public:
  Descriptor(int fd, FileOps& ops) : fd_(fd), ops_(&ops) {}
  ~Descriptor() {
    if (fd_ >= 0) ops_->Close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  int release() { return std::exchange(fd_, -1); }

 private:
  int fd_;
  FileOps* ops_;
};

// A failed fsync is final: the kernel may have thrown the data away, and a second fsync would say
// that all is well.
Status WriteAndSync(int fd, std::string_view bytes, const fs::path& path, FileOps& ops) {
  if (!WriteAll(fd, bytes, ops))
    return SystemError(path.string() + ": cannot write: " + ErrnoText());
  if (ops.Sync(fd) != 0) return SystemError(path.string() + ": fsync failed: " + ErrnoText());
  return {};
}

fs::path FolderOf(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

Status SyncDirectory(const fs::path& directory, FileOps& ops) {
  const Descriptor fd(ops.Open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC, 0), ops);
  if (fd.get() < 0 || ops.Sync(fd.get()) != 0)
    return SystemError(directory.string() + ": cannot sync the folder: " + ErrnoText());
  return {};
}

}  // namespace

int FileOps::Open(const char* path, int flags, mode_t mode) { return ::open(path, flags, mode); }
int FileOps::MakeTemporary(char* name) { return ::mkstemp(name); }
ssize_t FileOps::Write(int fd, const void* data, std::size_t size) {
  return ::write(fd, data, size);
}
int FileOps::Truncate(int fd, off_t size) { return ::ftruncate(fd, size); }
int FileOps::ChangeMode(int fd, mode_t mode) { return ::fchmod(fd, mode); }
int FileOps::Sync(int fd) { return ::fsync(fd); }
int FileOps::Close(int fd) { return ::close(fd); }
int FileOps::Lock(int fd) { return ::flock(fd, LOCK_EX | LOCK_NB); }
int FileOps::Rename(const char* from, const char* to) { return ::rename(from, to); }
int FileOps::Unlink(const char* path) { return ::unlink(path); }
int FileOps::MakeFolder(const char* path) { return ::mkdir(path, 0755); }
std::int64_t FileOps::FreeBytes(const char* path) {
  struct statvfs info {};
  if (::statvfs(path, &info) != 0) return -1;
  return static_cast<std::int64_t>(info.f_bavail * info.f_frsize);
}

FileOps& SystemFileOps() {
  static FileOps ops;
  return ops;
}

bool WriteAll(int fd, std::string_view bytes, FileOps& ops) {
  while (!bytes.empty()) {
    const ssize_t count = ops.Write(fd, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count == 0) errno = EIO;  // no progress, and no reason given
    if (count <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

Result<std::string> ReadFile(const fs::path& path, std::uint64_t max_bytes) {
  FileOps& ops = SystemFileOps();
  const Descriptor fd(ops.Open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK, 0), ops);
  if (fd.get() < 0) return InputError(path.string() + ": cannot open: " + ErrnoText());
  struct stat info {};
  if (::fstat(fd.get(), &info) != 0)
    return InputError(path.string() + ": cannot read: " + ErrnoText());
  if (S_ISDIR(info.st_mode)) return InputError(path.string() + ": a folder, allowed is a file");
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

std::string NearestPath(const fs::path& path) {
  std::error_code code;
  fs::path there;  // the part that exists
  auto missing = path.begin();
  while (missing != path.end() && fs::exists(there / *missing, code)) there /= *missing++;
  if (missing == path.end()) return "";
  std::vector<std::string> names;
  fs::directory_iterator entry(there.empty() ? fs::path(".") : there, code);
  for (; !code && entry != fs::directory_iterator(); entry.increment(code))
    names.push_back(entry->path().filename().string());
  std::sort(names.begin(), names.end());
  const std::string nearest = Nearest(missing->string(), names);
  if (nearest.empty()) return "";
  fs::path meant = there / nearest;
  for (auto rest = std::next(missing); rest != path.end(); ++rest) meant /= *rest;
  return fs::exists(meant, code) ? " (did you mean \"" + meant.string() + "\"?)" : "";
}

Result<std::string> ReadTypedFile(const fs::path& path, std::uint64_t max_bytes) {
  auto bytes = ReadFile(path, max_bytes);
  if (!bytes) return InputError(bytes.error().text + NearestPath(path));
  return bytes;
}

Status WriteFileAtomic(const fs::path& path, std::string_view bytes, FileOps& ops) {
  const fs::path directory = FolderOf(path);
  std::string temporary = (directory / ("." + path.filename().string() + kTemporaryEnd)).string();
  Descriptor fd(ops.MakeTemporary(temporary.data()), ops);
  if (fd.get() < 0) return SystemError(path.string() + ": cannot create: " + ErrnoText());
  Status status = WriteAndSync(fd.get(), bytes, path, ops);
  if (status && ops.ChangeMode(fd.get(), 0644) != 0)
    status = SystemError(path.string() + ": cannot set its mode: " + ErrnoText());
  if (ops.Close(fd.release()) != 0 && status)
    status = SystemError(path.string() + ": cannot close: " + ErrnoText());
  if (status && ops.Rename(temporary.c_str(), path.c_str()) != 0)
    status = SystemError(path.string() + ": cannot rename into place: " + ErrnoText());
  if (!status) {
    ops.Unlink(temporary.c_str());
    return status;
  }
  return SyncDirectory(directory, ops);
}

bool IsTemporaryName(std::string_view name) {
  const std::size_t end = sizeof(kTemporaryEnd) - 1;
  if (name.size() < end + 2 || name.front() != '.' || name[name.size() - end] != '.') return false;
  const std::string_view random = name.substr(name.size() - end + 1);
  return std::all_of(random.begin(), random.end(), [](unsigned char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  });
}

Status MakeDirectory(const fs::path& path, FileOps& ops) {
  std::error_code code;
  if (path.empty() || fs::is_directory(path, code)) return {};
  const fs::path plain = path.has_filename() ? path : path.parent_path();  // "a/b/"
  const fs::path parent = FolderOf(plain);
  if (parent != plain)
    if (const Status status = MakeDirectory(parent, ops); !status) return status;
  if (ops.MakeFolder(plain.c_str()) != 0) {
    const int reason = errno;
    if (reason == EEXIST && fs::is_directory(plain, code)) return {};
    return SystemError(path.string() + ": cannot create the folder: " + std::strerror(reason));
  }
  return SyncDirectory(parent, ops);
}

Result<AppendFile> AppendFile::Open(const fs::path& path, FileOps& ops) {
  const int fd =
      ops.Open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (fd < 0) return SystemError(path.string() + ": cannot open: " + ErrnoText());
  AppendFile file(path, fd, ops);
  if (const Status status = SyncDirectory(FolderOf(path), ops); !status) return Forward(status);
  return file;
}

AppendFile::~AppendFile() {
  if (fd_ >= 0) ops_->Close(fd_);
}

AppendFile::AppendFile(AppendFile&& other) noexcept
    : path_(std::move(other.path_)),
      fd_(std::exchange(other.fd_, -1)),
      ops_(other.ops_),
      failed_(other.failed_) {}

AppendFile& AppendFile::operator=(AppendFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(fd_, other.fd_);
  std::swap(ops_, other.ops_);
  std::swap(failed_, other.failed_);
  return *this;
}

Status AppendFile::Append(std::string_view bytes) {
  if (failed_) return SystemError(path_.string() + ": not written to after an error");
  const Status status = WriteAndSync(fd_, bytes, path_, *ops_);
  failed_ = !status;
  return status;
}

}  // namespace turnlight
