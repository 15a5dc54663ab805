// Preloaded into the program by tests: counts the calls that change files under a path and, at one
// of them, ends the process or lets the call fail. Set by the environment:
//   DISK_SHIM_UNDER  what the paths begin with
//   DISK_SHIM_DO     kill (after the call), nospace, error; short (a write writes half of it);
//                    interrupt (Ctrl-C before the call)
//   DISK_SHIM_AT     at which call, from 1; of short, at which write
//   DISK_SHIM_MARK   a file, written when it has happened: the call's name
// Nothing is synced: what a killed program has written stays in the system's cache.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

namespace {

std::string Variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

template <typename Function>
Function* Real(const char* name, Function*) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

bool Concerns(std::string_view path) {
  static const std::string under = Variable("DISK_SHIM_UNDER");
  return !under.empty() && path.substr(0, under.size()) == under;
}

bool Concerns(int fd) {
  char path[PATH_MAX];
  const std::string link = "/proc/self/fd/" + std::to_string(fd);
  const ssize_t length = ::readlink(link.c_str(), path, sizeof path);
  return length > 0 && Concerns(std::string_view(path, static_cast<std::size_t>(length)));
}

const std::string& What() {
  static const std::string what = Variable("DISK_SHIM_DO");
  return what;
}

// Whether this is the call; then it leaves its mark.
bool Now(const char* name) {
  static const int at = std::atoi(Variable("DISK_SHIM_AT").c_str());
  static std::atomic<int> calls{0};
  if (++calls != at) return false;
  if (std::FILE* mark = std::fopen(Variable("DISK_SHIM_MARK").c_str(), "w")) {
    std::fputs(name, mark);
    std::fclose(mark);
  }
  return true;
}

template <typename Call>
auto Step(const char* name, bool concerns, const Call& call) -> decltype(call()) {
  if (!concerns || What() == "short" || !Now(name)) return call();
  if (What() == "interrupt") {
    ::raise(SIGINT);
    return call();
  }
  if (What() == "kill") {
    call();
    ::kill(::getpid(), SIGKILL);
  }
  errno = What() == "nospace" ? ENOSPC : EIO;
  return -1;
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  static const auto real = Real("open", &open);
  std::va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(more, mode_t) : 0;
  va_end(more);
  const bool changes = (flags & (O_CREAT | O_WRONLY | O_RDWR)) != 0;
  const bool to_sync = (flags & O_DIRECTORY) != 0;
  return Step("open", (changes || to_sync) && Concerns(path),
              [&] { return real(path, flags, mode); });
}

ssize_t write(int fd, const void* data, size_t size) {
  static const auto real = Real("write", &write);
  const bool concerns = Concerns(fd);
  if (concerns && What() == "short" && Now("write")) return real(fd, data, (size + 1) / 2);
  return Step("write", concerns, [&] { return real(fd, data, size); });
}

int fsync(int fd) {
  return Step("fsync", Concerns(fd), [] { return 0; });
}

int fdatasync(int fd) {
  return Step("fdatasync", Concerns(fd), [] { return 0; });
}

int ftruncate(int fd, off_t size) noexcept {
  static const auto real = Real("ftruncate", &ftruncate);
  return Step("ftruncate", Concerns(fd), [&] { return real(fd, size); });
}

int fchmod(int fd, mode_t mode) noexcept {
  static const auto real = Real("fchmod", &fchmod);
  return Step("fchmod", Concerns(fd), [&] { return real(fd, mode); });
}

int rename(const char* from, const char* to) noexcept {
  static const auto real = Real("rename", &rename);
  return Step("rename", Concerns(to), [&] { return real(from, to); });
}

int unlink(const char* path) noexcept {
  static const auto real = Real("unlink", &unlink);
  return Step("unlink", Concerns(path), [&] { return real(path); });
}

int mkstemp(char* name) {
  static const auto real = Real("mkstemp", &mkstemp);
  return Step("mkstemp", Concerns(name), [&] { return real(name); });
}

int mkdir(const char* path, mode_t mode) noexcept {
  static const auto real = Real("mkdir", &mkdir);
  return Step("mkdir", Concerns(path), [&] { return real(path, mode); });
}

}  // extern "C"
