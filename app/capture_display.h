// What a person sees while a capture runs, on standard error: on a terminal a few lines that are
// rewritten, with the faults above them; elsewhere a plain line for each event.
#pragma once

#include <cstddef>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "base/stopwatch.h"
#include "nodes/messages.h"

namespace turnlight::app {

class CaptureDisplay {
 public:
  // total: frames that the plan has; done: those that were there before.
  CaptureDisplay(std::size_t total, std::size_t done);

  // From any thread.
  void OnBracket(const nodes::Bracket& bracket);
  void OnEstimate(const nodes::Estimate& estimate);
  void OnLine(const std::string& line);
  void OnPace(const nodes::Pace& pace);
  void OnGuidance(const nodes::Guidance& guidance);
  void OnVerdict(const nodes::Verdict& verdict);

  // After the run: leaves what is on the terminal there. With real time, tells where it went.
  void End(bool real_time);
  // Whether OnLine was called with it.
  bool Showed(const std::string& line);
  // All that came, in their order.
  const std::vector<nodes::Estimate>& estimates() const { return estimates_; }

  // "frame 3/36 at 20\u00b0, 1 retry"; by hand without the angle.
  static std::string BracketText(const nodes::Bracket& bracket, std::size_t done,
                                 std::size_t total);
  // "36 frames in 41.3 s, 52.3 a minute; waited for the stage 61 %, ...". seconds: since it began.
  static std::string PaceText(const nodes::Pace& pace, std::size_t frames, double seconds);
  // "12 of 36: move on to the left".
  static std::string GuidanceText(const nodes::Guidance& guidance);
  // "(+0.505, +0.202, +0.841) \u00b1 0.05\u00b0".
  static std::string LightText(const nodes::LightNow& light);
  // The first columns of a line, each character counted as one.
  static std::string Cut(const std::string& line, std::size_t columns);

 private:
  void Show(const std::string& event);  // mutex_ is held
  void Erase();
  void Draw();

  const std::size_t total_;
  const std::size_t before_;
  const bool terminal_;
  const Stopwatch stopwatch_;
  std::mutex mutex_;
  std::size_t done_;
  std::string frame_text_, guidance_text_;
  std::vector<nodes::Estimate> estimates_;
  std::set<std::string> shown_;
  nodes::Pace pace_;  // of all keyframes
  std::size_t paced_ = 0;
  std::size_t drawn_ = 0;  // lines on the terminal
};

}  // namespace turnlight::app
