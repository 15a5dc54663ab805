#include "tests/rig/serial/tiny_controller.h"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

namespace turnlight::rig::serial {

TinyController::TinyController(std::string name)
    : name_(std::move(name)), master_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
  grantpt(master_);
  unlockpt(master_);
  path_ = ptsname(master_);
  // Raw from the start: nothing is echoed before the client sets its own mode.
  termios raw{};
  tcgetattr(master_, &raw);
  cfmakeraw(&raw);
  tcsetattr(master_, TCSANOW, &raw);
  Say("\r\nGrbl 1.1h ['$' for help]\r\n");  // waits there for who opens it
  thread_ = std::thread([this] { Run(); });
}

TinyController::~TinyController() { Unplug(); }

void TinyController::Unplug() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  if (master_ >= 0) close(std::exchange(master_, -1));
}

std::string TinyController::Heard() const {
  const std::lock_guard lock(mutex_);
  return heard_;
}

void TinyController::Say(const std::string& text) {
  if (!mute_ && write(master_, text.data(), text.size()) < 0) stop_ = true;
}

void TinyController::OnLine(const std::string& line) {
  {
    const std::lock_guard lock(mutex_);
    heard_ += line + "\n";
  }
  if (line == "$I") Say("[VER:1.1h.20190825:" + name_ + "]\r\n[OPT:V,15,128]\r\n");
  if (line == "$$")
    Say("$13=0\r\n$20=0\r\n$22=1\r\n$100=1000.000\r\n$110=6000.000\r\n$120=500.000\r\n");
  if (line == "$H") position_ = 0.0;
  if (const std::size_t x = line.find('X'); x != std::string::npos)
    position_ = std::atof(line.c_str() + x + 1);
  Say("ok\r\n");
}

void TinyController::Run() {
  std::string line;
  while (!stop_) {
    pollfd file{master_, POLLIN, 0};
    char byte = 0;
    // Nobody has the other end open: POLLHUP, and nothing to read.
    if (poll(&file, 1, 20) <= 0 || !(file.revents & POLLIN) || read(master_, &byte, 1) != 1) {
      if (file.revents & POLLHUP) std::this_thread::sleep_for(std::chrono::milliseconds(5));
      continue;
    }
    char report[80];
    std::snprintf(report, sizeof report, "<Idle|MPos:%.3f,0.000,0.000|FS:0,0>\r\n", position_);
    if (byte == '?') {
      Say(report);
    } else if (byte == '\n') {
      OnLine(std::exchange(line, ""));
    } else {
      line += byte;
    }
  }
}

}  // namespace turnlight::rig::serial
