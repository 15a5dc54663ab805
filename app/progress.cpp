#include "app/progress.h"

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <utility>

#include "base/printable.h"

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

StatusLine::StatusLine()
    : terminal_(::isatty(STDERR_FILENO) == 1), next_s_(terminal_ ? 0.0 : kPlainPeriod) {}

StatusLine::~StatusLine() {
  if (terminal_ && shown_) std::fputs("\r\033[K", stderr);
}

void StatusLine::Show(const std::string& text, bool last) {
  const double seconds = stopwatch_.Seconds();
  shown_ = true;
  if (seconds < next_s_ && !last) return;
  next_s_ = seconds + (terminal_ ? kTerminalPeriod : kPlainPeriod);
  const std::string shown = Printable(text);
  if (terminal_)
    std::fprintf(stderr, "\r\033[K%s", shown.c_str());
  else
    std::fprintf(stderr, "%s\n", shown.c_str());
  std::fflush(stderr);
}

Progress::Progress(std::string label, std::size_t total)
    : label_(std::move(label)), total_(total) {}

void Progress::Step() {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++done_;
  line_.Show(Line(label_, done_, total_, stopwatch_.Seconds()), done_ == total_);
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
