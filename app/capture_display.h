// What a person sees while a capture runs, on standard error: on a terminal one line that is
// rewritten, with the faults above it; elsewhere a plain line for each event.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

#include "nodes/messages.h"

namespace turnlight::app {

class CaptureDisplay {
 public:
  // total: frames that the plan has; done: those that were there before.
  CaptureDisplay(std::size_t total, std::size_t done);
  ~CaptureDisplay();
  CaptureDisplay(const CaptureDisplay&) = delete;
  CaptureDisplay& operator=(const CaptureDisplay&) = delete;

  // From any thread.
  void OnBracket(const nodes::Bracket& bracket);
  void OnEstimate(const nodes::Estimate& estimate);
  void OnLine(const std::string& line);

  // "frame 3/36 at 20.0 deg, 1 retry".
  static std::string BracketText(const nodes::Bracket& bracket, std::size_t done,
                                 std::size_t total);
  // "2 lights: (+0.51, +0.20, +0.84) 0.05 deg, ...; residual 0.0051".
  static std::string EstimateText(const nodes::Estimate& estimate);

 private:
  void Show(const std::string& event);  // mutex_ is held

  const std::size_t total_;
  const std::size_t before_;
  const bool terminal_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::mutex mutex_;
  std::size_t done_;
  std::string frame_text_, estimate_text_;
};

}  // namespace turnlight::app
