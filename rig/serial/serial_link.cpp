#include "rig/serial/serial_link.h"

#include <fcntl.h>
#include <libserialport.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

namespace turnlight::rig::serial {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxRead = 65536;

std::string SystemWords(int error) { return std::strerror(error); }

// Whether the other end is gone; what it said before that is still to be read.
bool HungUp(int handle) {
  pollfd state{handle, POLLIN, 0};
  return poll(&state, 1, 0) > 0 && (state.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0;
}

tl::unexpected<Error> Gone() {
  return DeviceError("the port is gone: unplugged, or its other end closed");
}

// How an open that was refused is mended.
std::string OpenFailed(const std::string& path, int error) {
  std::string text = path + ": " + SystemWords(error);
  if (error == EACCES || error == EPERM)
    text +=
        "; your user may not open serial ports: sudo usermod -aG dialout $USER, then log in anew";
  if (error == EBUSY) text += ", held by " + HoldersOf(path);
  return text;
}

// Fails with the holder's name.
Status TakeLock(int handle, const std::string& path) {
  if (flock(handle, LOCK_EX | LOCK_NB) == 0) return {};
  if (errno != EWOULDBLOCK) return {};  // a file system without locks
  const std::string holders = HoldersOf(path);
  return DeviceError(path + ": in use by " +
                     (holders.empty() ? "another program, which this user may not see" : holders));
}

class PortLink : public SerialLink {
 public:
  explicit PortLink(sp_port* port) : port_(port) {}
  ~PortLink() override {
    sp_close(port_);
    sp_free_port(port_);
  }
  PortLink(const PortLink&) = delete;
  PortLink& operator=(const PortLink&) = delete;

  int handle() const override {
    int handle = -1;
    sp_get_port_handle(port_, &handle);
    return handle;
  }
  Result<std::string> Read() override {
    std::string bytes(kMaxRead, '\0');
    const int count = sp_nonblocking_read(port_, bytes.data(), bytes.size());
    if (count < 0 || (count == 0 && HungUp(handle()))) return Gone();
    bytes.resize(static_cast<std::size_t>(count));
    return bytes;
  }
  Result<std::size_t> Write(std::string_view bytes) override {
    const int count = sp_nonblocking_write(port_, bytes.data(), bytes.size());
    if (count < 0) return Gone();
    return static_cast<std::size_t>(count);
  }
  std::string Backend() const override { return "libserialport"; }

 private:
  sp_port* port_;
};

class PtyLink : public SerialLink {
 public:
  explicit PtyLink(int handle) : handle_(handle) {}
  ~PtyLink() override { close(handle_); }
  PtyLink(const PtyLink&) = delete;
  PtyLink& operator=(const PtyLink&) = delete;

  int handle() const override { return handle_; }
  Result<std::string> Read() override {
    std::string bytes(kMaxRead, '\0');
    const ssize_t count = read(handle_, bytes.data(), bytes.size());
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return std::string();
    if (count < 0 || (count == 0 && HungUp(handle_))) return Gone();
    bytes.resize(static_cast<std::size_t>(count));
    return bytes;
  }
  Result<std::size_t> Write(std::string_view bytes) override {
    const ssize_t count = write(handle_, bytes.data(), bytes.size());
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return std::size_t{0};
    if (count < 0) return Gone();
    return static_cast<std::size_t>(count);
  }
  std::string Backend() const override { return "termios (pseudo-terminal)"; }

 private:
  int handle_;
};

// Linux gives these numbers to the slaves of pseudo-terminals.
bool IsPseudoTerminal(const std::string& path) {
  struct stat info {};
  return stat(path.c_str(), &info) == 0 && S_ISCHR(info.st_mode) && major(info.st_rdev) >= 136 &&
         major(info.st_rdev) <= 143;
}

Result<std::unique_ptr<SerialLink>> OpenPty(const std::string& path) {
  const int handle = open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (handle < 0) return DeviceError(OpenFailed(path, errno));
  auto link = std::make_unique<PtyLink>(handle);
  if (const Status locked = TakeLock(handle, path); !locked) return Forward(locked);
  termios settings{};
  if (tcgetattr(handle, &settings) != 0) return DeviceError(path + ": " + SystemWords(errno));
  cfmakeraw(&settings);
  settings.c_cc[VMIN] = 0;
  settings.c_cc[VTIME] = 0;
  if (tcsetattr(handle, TCSANOW, &settings) != 0)
    return DeviceError(path + ": " + SystemWords(errno));
  return link;
}

std::string LibraryWords() {
  char* const words = sp_last_error_message();
  const std::string text = words ? words : "unknown error";
  sp_free_error_message(words);
  return text;
}

Status Configure(sp_port* port, const std::string& path, const LineSettings& settings) {
  const sp_flowcontrol flow = settings.flow == FlowControl::kXonXoff  ? SP_FLOWCONTROL_XONXOFF
                              : settings.flow == FlowControl::kRtsCts ? SP_FLOWCONTROL_RTSCTS
                                                                      : SP_FLOWCONTROL_NONE;
  if (sp_set_baudrate(port, settings.baud) == SP_OK && sp_set_bits(port, 8) == SP_OK &&
      sp_set_parity(port, SP_PARITY_NONE) == SP_OK && sp_set_stopbits(port, 1) == SP_OK &&
      sp_set_flowcontrol(port, flow) == SP_OK)
    return {};
  return DeviceError(path + ": its line cannot be set to " + std::to_string(settings.baud) +
                     " baud, 8N1: " + LibraryWords());
}

Result<std::unique_ptr<SerialLink>> OpenPort(sp_port* port, const std::string& path,
                                             const LineSettings& settings) {
  if (sp_open(port, SP_MODE_READ_WRITE) != SP_OK) {
    const int error = sp_last_error_code();
    sp_free_port(port);
    return DeviceError(OpenFailed(path, error));
  }
  auto link = std::make_unique<PortLink>(port);
  if (const Status locked = TakeLock(link->handle(), path); !locked) return Forward(locked);
  if (const Status set = Configure(port, path, settings); !set) return Forward(set);
  return link;
}

}  // namespace

Result<std::unique_ptr<SerialLink>> OpenSerialLink(const std::string& path,
                                                   const LineSettings& settings) {
  std::array<char, PATH_MAX> real{};
  if (!realpath(path.c_str(), real.data()))
    return DeviceError(path + ": " + SystemWords(errno) +
                       "; turnlight devices lists the ports that are there");
  const std::string device = real.data();
  sp_port* port = nullptr;
  if (sp_get_port_by_name(device.c_str(), &port) == SP_OK) return OpenPort(port, device, settings);
  if (IsPseudoTerminal(device)) return OpenPty(device);
  return DeviceError(path +
                     ": no serial port, allowed is one of those that turnlight devices lists");
}

std::string HoldersOf(const std::string& path) {
  std::error_code error;
  const fs::path device = fs::canonical(path, error);
  std::string holders;
  for (const auto& process : fs::directory_iterator("/proc", error)) {
    const std::string pid = process.path().filename();
    if (pid.find_first_not_of("0123456789") != std::string::npos || pid == std::to_string(getpid()))
      continue;
    std::error_code unreadable;
    for (fs::directory_iterator file(process.path() / "fd", unreadable), end;
         !unreadable && file != end; file.increment(unreadable)) {
      std::error_code closed;
      if (fs::read_symlink(file->path(), closed) != device || closed) continue;
      std::string name;
      std::getline(std::ifstream(process.path() / "comm"), name);
      holders += (holders.empty() ? "" : ", ") + name + " (process " + pid + ")";
      break;
    }
  }
  return holders;
}

}  // namespace turnlight::rig::serial
