#include "app/progress.h"

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <utility>

namespace turnlight::app {
namespace {

constexpr double kTerminalPeriod = 0.1;  // seconds
constexpr double kPlainPeriod = 10.0;

}  // namespace

std::string TimeLeft(double seconds) {
  const auto s = static_cast<long>(std::ceil(seconds));
  char text[48];
  if (s < 60)
    std::snprintf(text, sizeof text, "%ld s left", s);
  else if (s < 3600)
    std::snprintf(text, sizeof text, "%ld min %02ld s left", s / 60, s % 60);
  else
    std::snprintf(text, sizeof text, "%ld h %02ld min left", s / 3600, s / 60 % 60);
  return text;
}

Progress::Progress(std::string label, std::size_t total)
    : label_(std::move(label)),
      total_(total),
      terminal_(::isatty(STDERR_FILENO) == 1),
      next_s_(terminal_ ? 0.0 : kPlainPeriod) {}

Progress::~Progress() {
  if (terminal_ && done_ > 0) std::fputs("\r\033[K", stderr);
}

void Progress::Step() {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++done_;
  const double seconds = stopwatch_.Seconds();
  const bool last = done_ == total_;
  if (seconds < next_s_ && !last) return;
  next_s_ = seconds + (terminal_ ? kTerminalPeriod : kPlainPeriod);
  const std::string line = Line(label_, done_, total_, seconds);
  if (terminal_)
    std::fprintf(stderr, "\r\033[K%s", line.c_str());
  else
    std::fprintf(stderr, "%s\n", line.c_str());
  std::fflush(stderr);
}

std::string Progress::Line(const std::string& label, std::size_t done, std::size_t total,
                           double seconds) {
  std::string line = label + " " + std::to_string(done) + "/" + std::to_string(total);
  if (done == 0 || !(seconds > 0.0)) return line;
  const double rate = static_cast<double>(done) / seconds;
  char text[48];
  std::snprintf(text, sizeof text, ", %.3g per s", rate);
  line += text;
  if (done < total) line += ", " + TimeLeft(static_cast<double>(total - done) / rate);
  return line;
}

}  // namespace turnlight::app
