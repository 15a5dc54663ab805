// How far a loop over frames has come, on standard error: one line that is rewritten, with rate and
// time left, on a terminal; elsewhere a plain line now and then.
#pragma once

#include <cstddef>
#include <mutex>
#include <string>

#include "base/stopwatch.h"

namespace turnlight::app {

// "8 s left", "3 min 18 s left", "2 h 46 min left".
std::string TimeLeft(double seconds);

class Progress {
 public:
  // What is done to each, such as "rendering", and how many there are.
  Progress(std::string label, std::size_t total);
  ~Progress();
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
  const bool terminal_;
  const Stopwatch stopwatch_;
  std::mutex mutex_;
  std::size_t done_ = 0;
  double next_s_ = 0.0;  // when the next line is due
};

}  // namespace turnlight::app
