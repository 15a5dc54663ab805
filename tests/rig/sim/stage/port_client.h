// A plain termios client of a simulated port, with deadlines: what anyone's terminal program does.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <string>
#include <utility>

namespace turnlight::rig::sim::stage {

// A folder of its own, gone at the end.
class PortFolder {
 public:
  PortFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "stage_XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~PortFolder() { std::filesystem::remove_all(path_); }
  PortFolder(const PortFolder&) = delete;
  PortFolder& operator=(const PortFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

class PortClient {
 public:
  explicit PortClient(const std::string& path)
      : fd_(open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK)) {
    termios mode{};
    if (tcgetattr(fd_, &mode) != 0) return;
    cfmakeraw(&mode);
    tcsetattr(fd_, TCSANOW, &mode);
  }
  ~PortClient() {
    if (fd_ >= 0) close(fd_);
  }
  PortClient(PortClient&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  PortClient& operator=(PortClient&&) = delete;

  bool IsOpen() const { return fd_ >= 0; }
  bool Write(const std::string& bytes) {
    return write(fd_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
  }
  // Everything up to the first `end`, or what came until the deadline or a hang-up.
  std::string ReadUntil(const std::string& end, int ms = 20000) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::milliseconds(ms);
    while (received_.find(end) == std::string::npos && !hung_up_ &&
           std::chrono::steady_clock::now() < deadline)
      ReadSome();
    const std::size_t found = received_.find(end);
    const std::size_t count = found == std::string::npos ? received_.size() : found + end.size();
    std::string taken = received_.substr(0, count);
    received_.erase(0, count);
    return taken;
  }
  std::string Ask(const std::string& bytes, const std::string& end) {
    return Write(bytes) ? ReadUntil(end) : std::string();
  }
  bool SeesHangUp(int ms = 20000) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::milliseconds(ms);
    while (!hung_up_ && std::chrono::steady_clock::now() < deadline) ReadSome();
    return hung_up_;
  }

 private:
  void ReadSome() {
    pollfd entry{fd_, POLLIN, 0};
    poll(&entry, 1, 10);
    std::array<char, 4096> buffer{};
    const ssize_t count = read(fd_, buffer.data(), buffer.size());
    if (count > 0) received_.append(buffer.data(), static_cast<std::size_t>(count));
    if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) hung_up_ = true;
  }

  int fd_;
  std::string received_;
  bool hung_up_ = false;
};

}  // namespace turnlight::rig::sim::stage
