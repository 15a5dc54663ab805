// Lets libserialport take a pseudo-terminal for a serial port, so that its own code runs against a
// simulated controller. Linked into a program; there it stands before the C library's functions of
// these names.
//
// The library looks a port up in /sys/class/tty, where no pseudo-terminal is, and reads and sets
// the modem's lines, which none has. Both are answered here for pseudo-terminals; all else passes.
#include <dlfcn.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <cstdarg>
#include <cstring>
#include <string_view>

namespace {

constexpr std::string_view kFolder = "/sys/class/tty/pts/";
constexpr std::string_view kDevice = "../../devices/virtual/tty/pts";

bool IsPtyEntry(const char* path) {
  return std::string_view(path).substr(0, kFolder.size()) == kFolder;
}

bool IsPty(int file) {
  struct stat info {};
  return fstat(file, &info) == 0 && S_ISCHR(info.st_mode) && major(info.st_rdev) >= 136 &&
         major(info.st_rdev) <= 143;
}

}  // namespace

extern "C" {

// lstat, as programs call it that were built before glibc 2.33.
int __lxstat(int, const char* path, struct stat* info) {  // NOLINT: the C library's name
  if (!IsPtyEntry(path)) return lstat(path, info);
  std::memset(info, 0, sizeof *info);
  info->st_mode = S_IFLNK | 0777;
  return 0;
}

ssize_t readlink(const char* path, char* buffer, size_t size) noexcept {
  using Function = ssize_t (*)(const char*, char*, size_t);
  static const auto next = reinterpret_cast<Function>(dlsym(RTLD_NEXT, "readlink"));
  if (!IsPtyEntry(path)) return next(path, buffer, size);
  const size_t count = std::min(size, kDevice.size());
  std::memcpy(buffer, kDevice.data(), count);
  return static_cast<ssize_t>(count);
}

int ioctl(int file, unsigned long request, ...) noexcept {
  using Function = int (*)(int, unsigned long, ...);
  static const auto next = reinterpret_cast<Function>(dlsym(RTLD_NEXT, "ioctl"));
  va_list arguments;
  va_start(arguments, request);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  const bool modem =
      request == TIOCMGET || request == TIOCMSET || request == TIOCMBIS || request == TIOCMBIC;
  if (!modem || !IsPty(file)) return next(file, request, argument);
  if (request == TIOCMGET) *static_cast<int*>(argument) = TIOCM_DTR | TIOCM_RTS | TIOCM_CAR;
  return 0;
}

}  // extern "C"
