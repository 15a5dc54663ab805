#include "tests/app/listener.h"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <utility>

namespace turnlight::app {
namespace {

// The two ends: ours, the program's.
std::pair<int, int> OpenLine(Line line) {
  if (line != Line::kTerminal && line != Line::kForeignTerminal) {
    std::array<int, 2> ends{};
    return ::pipe2(ends.data(), O_CLOEXEC) == 0 ? std::pair(ends[0], ends[1]) : std::pair(-1, -1);
  }
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  ::grantpt(master);
  ::unlockpt(master);
  return {master, ::open(::ptsname(master), O_RDWR | O_NOCTTY | O_CLOEXEC)};
}

[[noreturn]] void Become(Line line, int end, Hangup hangup, char** argv) {
  if (line == Line::kTerminal) {
    ::setsid();
    ::ioctl(end, TIOCSCTTY, 0);
    ::dup2(end, STDIN_FILENO);
  }
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  ::dup2(line == Line::kPipeOfErrors ? nowhere : end, STDOUT_FILENO);
  ::dup2(line == Line::kPipeOfOutput ? nowhere : end, STDERR_FILENO);
  if (hangup == Hangup::kIgnored) ::signal(SIGHUP, SIG_IGN);
  ::execv(TURNLIGHT_PROGRAM, argv);
  ::_exit(127);
}

}  // namespace

Listener::Listener(Line line, const std::vector<std::string>& arguments, Hangup hangup) {
  std::vector<char*> argv{const_cast<char*>(TURNLIGHT_PROGRAM)};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const auto [ours, its] = OpenLine(line);
  end_ = ours;
  process_ = ::fork();
  if (process_ == 0) Become(line, its, hangup, argv.data());
  ::close(its);
}

Listener::~Listener() { Leave(); }

bool Listener::Hears(const std::string& text) {
  for (int i = 0; i < 3000 && heard_.find(text) == std::string::npos; ++i) {
    pollfd wait{end_, POLLIN, 0};
    std::array<char, 4096> bytes{};
    if (::poll(&wait, 1, 10) <= 0) continue;
    const ssize_t count = ::read(end_, bytes.data(), bytes.size());
    if (count <= 0) break;
    heard_.append(bytes.data(), static_cast<std::size_t>(count));
  }
  return heard_.find(text) != std::string::npos;
}

void Listener::Leave() {
  if (end_ >= 0) ::close(std::exchange(end_, -1));
}

int Listener::Finish() {
  int status = 0;
  for (int i = 0; i < 3000; ++i) {
    if (::waitpid(process_, &status, WNOHANG) == process_)
      return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    ::usleep(10'000);
  }
  ::kill(process_, SIGKILL);
  ::waitpid(process_, &status, 0);
  return -1;
}

}  // namespace turnlight::app
