#include "app/interrupt.h"

#include <unistd.h>

#include <atomic>
#include <csignal>

#include "app/command.h"

namespace turnlight::app {
namespace {

constexpr char kText[] = "\nturnlight: interrupted\n";

std::atomic<bool> interrupted{false};
std::atomic<int> at_once{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "a signal handler may touch them");

void HandleInterrupt(int) {
  const bool second = interrupted.exchange(true);
  if (second || at_once.load() > 0) {
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kText, sizeof kText - 1);
    ::_exit(kInterrupted);
  }
}

}  // namespace

void InstallInterruptHandler() {
  struct sigaction action {};
  action.sa_handler = HandleInterrupt;
  action.sa_flags = SA_RESTART;
  ::sigaction(SIGINT, &action, nullptr);
}

bool Interrupted() { return interrupted.load(); }

InterruptAtOnce::InterruptAtOnce() { ++at_once; }
InterruptAtOnce::~InterruptAtOnce() { --at_once; }

}  // namespace turnlight::app
