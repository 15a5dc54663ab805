#include "app/calibrate/prompt.h"

#include <poll.h>
#include <unistd.h>

#include <iostream>

namespace turnlight::app {
namespace {

constexpr int kPromptPollMs = 100;

}  // namespace

Status WaitForEnter(const std::string& text, const StopFlag* stop) {
  std::cerr << text << std::flush;
  while (!StopRequested(stop)) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, 1, kPromptPollMs) <= 0) continue;
    char byte = 0;
    if (::read(STDIN_FILENO, &byte, 1) <= 0) {
      std::cerr << std::endl;
      if (StopRequested(stop)) return InterruptedError();  // the terminal was closed
      return InputError(
          "standard input has ended, so nobody can be asked to go on; --yes asks nobody");
    }
    if (byte == '\n') return {};
  }
  std::cerr << std::endl;
  return InterruptedError();
}

}  // namespace turnlight::app
