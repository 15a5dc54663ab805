// Preloaded into the program by disk_faults_test: counts the calls that change files under a folder
// and, at one of them, ends the process or lets the call fail. Set by the environment:
//   DISK_SHIM_UNDER  the folder
//   DISK_SHIM_DO     kill (after the call), nospace, error; short (a write writes half of it)
//   DISK_SHIM_AT     at which call, from 1; of short, at which write
#include <dlfcn.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
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

// Whether this is the call.
bool Now() {
  static const int at = std::atoi(Variable("DISK_SHIM_AT").c_str());
  static std::atomic<int> calls{0};
  return ++calls == at;
}

template <typename Call>
auto Step(bool concerns, const Call& call) -> decltype(call()) {
  if (!concerns || What() == "short" || !Now()) return call();
  if (What() == "kill") {
    call();
    ::kill(::getpid(), SIGKILL);
  }
  errno = What() == "nospace" ? ENOSPC : EIO;
  return -1;
}

}  // namespace

extern "C" {

ssize_t write(int fd, const void* data, size_t size) {
  static const auto real = Real("write", &write);
  const bool concerns = Concerns(fd);
  if (concerns && What() == "short" && Now()) return real(fd, data, (size + 1) / 2);
  return Step(concerns, [&] { return real(fd, data, size); });
}

int fsync(int fd) {
  static const auto real = Real("fsync", &fsync);
  return Step(Concerns(fd), [&] { return real(fd); });
}

int fdatasync(int fd) {
  static const auto real = Real("fdatasync", &fdatasync);
  return Step(Concerns(fd), [&] { return real(fd); });
}

int rename(const char* from, const char* to) noexcept {
  static const auto real = Real("rename", &rename);
  return Step(Concerns(to), [&] { return real(from, to); });
}

int mkstemp(char* name) {
  static const auto real = Real("mkstemp", &mkstemp);
  return Step(Concerns(name), [&] { return real(name); });
}

int mkdir(const char* path, mode_t mode) noexcept {
  static const auto real = Real("mkdir", &mkdir);
  return Step(Concerns(path), [&] { return real(path, mode); });
}

}  // extern "C"
