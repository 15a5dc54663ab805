#include "app/capture_display.h"

#include <unistd.h>

#include <cstdio>

namespace turnlight::app {

CaptureDisplay::CaptureDisplay(std::size_t total, std::size_t done)
    : total_(total), before_(done), terminal_(::isatty(STDERR_FILENO) == 1), done_(done) {}

CaptureDisplay::~CaptureDisplay() {
  if (terminal_) std::fputs("\n", stderr);
}

std::string CaptureDisplay::BracketText(const nodes::Bracket& bracket, std::size_t done,
                                        std::size_t total) {
  char text[96];
  std::snprintf(text, sizeof text, "frame %zu/%zu at %.6g\u00b0", done, total, bracket.angle_deg);
  const int retries = bracket.attempts - 1;
  return text + (retries == 0   ? std::string()
                 : retries == 1 ? ", 1 retry"
                                : ", " + std::to_string(retries) + " retries");
}

std::string CaptureDisplay::EstimateText(const nodes::Estimate& estimate) {
  std::string text = std::to_string(estimate.lights.size()) +
                     (estimate.lights.size() == 1 ? " light:" : " lights:");
  char part[128];
  for (const nodes::LightNow& light : estimate.lights) {
    std::snprintf(part, sizeof part, " (%+.3f, %+.3f, %+.3f) \u00b1 %.2g\u00b0,",
                  light.direction.x(), light.direction.y(), light.direction.z(),
                  light.direction_sigma_deg);
    text += part;
  }
  std::snprintf(part, sizeof part, " residual %.3g", estimate.rms);
  return text + part;
}

void CaptureDisplay::OnBracket(const nodes::Bracket& bracket) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++done_;
  frame_text_ = BracketText(bracket, done_, total_);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  if (done_ < total_) {
    const double left =
        seconds / static_cast<double>(done_ - before_) * static_cast<double>(total_ - done_);
    frame_text_ += ", " + std::to_string(static_cast<long>(left) + 1) + " s left";
  }
  Show(frame_text_);
}

void CaptureDisplay::OnEstimate(const nodes::Estimate& estimate) {
  const std::lock_guard<std::mutex> lock(mutex_);
  estimate_text_ = "after " + std::to_string(estimate.keyframes) + ": " + EstimateText(estimate);
  Show("estimate " + estimate_text_);
}

void CaptureDisplay::OnLine(const std::string& line) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (terminal_) std::fprintf(stderr, "\r\033[K%s\n", line.c_str());
  Show(line);
}

void CaptureDisplay::Show(const std::string& event) {
  if (terminal_)
    std::fprintf(stderr, "\r\033[K%s%s%s", frame_text_.c_str(), estimate_text_.empty() ? "" : " | ",
                 estimate_text_.c_str());
  else
    std::fprintf(stderr, "%s\n", event.c_str());
  std::fflush(stderr);
}

}  // namespace turnlight::app
