// How far something has come, on standard error: one line that is rewritten on a terminal;
// elsewhere a plain line now and then. Of a loop over frames with rate and time left.
#pragma once

#include <cstddef>
#include <mutex>
#include <string>

#include "base/stopwatch.h"

namespace turnlight::app {

// "8 s left", "3 min 18 s left", "2 h 46 min left".
std::string TimeLeft(double seconds);

// A line that is rewritten on a terminal; elsewhere one now and then. Gone from a terminal at the
// end. Not for several threads.
class StatusLine {
 public:
  StatusLine();
  ~StatusLine();
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  // last: shown in any case.
  void Show(const std::string& text, bool last = false);

 private:
  const bool terminal_;
  const Stopwatch stopwatch_;
  bool shown_ = false;
  double next_s_;  // when the next line is due
};

class Progress {
 public:
  // What is done to each, such as "rendering", and how many there are.
  Progress(std::string label, std::size_t total);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // One more is done. May be called from several threads.
  void Step();

  // The line's text after `done` in `seconds`, for example "rendering 12/36, 4.1 per s, 6 s left".
  static std::string Line(const std::string& label, std::size_t done, std::size_t total,
                          double seconds);

 private:
  const std::string label_;
  const std::size_t total_;
  const Stopwatch stopwatch_;
  std::mutex mutex_;
  std::size_t done_ = 0;
  StatusLine line_;
};

}  // namespace turnlight::app
