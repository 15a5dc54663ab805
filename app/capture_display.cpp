#include "app/capture_display.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "app/progress.h"
#include "base/format.h"
#include "base/printable.h"

namespace turnlight::app {
namespace {

std::size_t TerminalColumns() {
  struct winsize size {};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string Residual(const nodes::Estimate& estimate) {
  char text[48];
  std::snprintf(text, sizeof text, "residual %.3g", estimate.rms);
  return text;
}

std::string Lights(const nodes::Estimate& estimate) {
  return std::to_string(estimate.lights.size()) +
         (estimate.lights.size() == 1 ? " light" : " lights");
}

}  // namespace

CaptureDisplay::CaptureDisplay(std::size_t total, std::size_t done)
    : total_(total), before_(done), terminal_(::isatty(STDERR_FILENO) == 1), done_(done) {}

std::string CaptureDisplay::BracketText(const nodes::Bracket& bracket, std::size_t done,
                                        std::size_t total) {
  char text[96];
  if (bracket.placed)
    std::snprintf(text, sizeof text, "frame %zu/%zu", done, total);
  else
    std::snprintf(text, sizeof text, "frame %zu/%zu at %.6g\u00b0%s", done, total,
                  bracket.angle_deg, bracket.closure ? " (closure)" : "");
  const int retries = bracket.attempts - 1;
  return text + (retries == 0   ? std::string()
                 : retries == 1 ? ", 1 retry"
                                : ", " + std::to_string(retries) + " retries");
}

std::string CaptureDisplay::GuidanceText(const nodes::Guidance& guidance) {
  return Format("%llu of %llu: ", static_cast<unsigned long long>(guidance.done),
                static_cast<unsigned long long>(guidance.total)) +
         guidance.text;
}

std::string CaptureDisplay::LightText(const nodes::LightNow& light) {
  char text[128];
  std::snprintf(text, sizeof text, "(%+.3f, %+.3f, %+.3f) \u00b1 %.2g\u00b0", light.direction.x(),
                light.direction.y(), light.direction.z(), light.direction_sigma_deg);
  return text;
}

std::string CaptureDisplay::Cut(const std::string& line, std::size_t columns) {
  std::size_t characters = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool begins = (static_cast<unsigned char>(line[i]) & 0xC0) != 0x80;  // UTF-8
    if (begins && ++characters > columns) return line.substr(0, i);
  }
  return line;
}

std::string CaptureDisplay::PaceText(const nodes::Pace& pace, std::size_t frames, double seconds) {
  const auto share = [&](double part) { return Format("%.0f %%", 100.0 * part / seconds); };
  std::string text = Format("%zu frames in %.1f s, %.1f a minute", frames, seconds,
                            60.0 * static_cast<double>(frames) / seconds);
  text += "; waited for the stage " + share(pace.stage) + ", its settling " + share(pace.settling) +
          ", the camera " + share(pace.camera) + ", the disk " + share(pace.storing);
  return pace.resting > 0.0 ? text + ", before repetitions " + share(pace.resting) : text;
}

void CaptureDisplay::OnPace(const nodes::Pace& pace) {
  const std::lock_guard<std::mutex> lock(mutex_);
  pace_.stage += pace.stage;
  pace_.settling += pace.settling;
  pace_.camera += pace.camera;
  pace_.storing += pace.storing;
  pace_.resting += pace.resting;
  ++paced_;
}

void CaptureDisplay::OnBracket(const nodes::Bracket& bracket) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++done_;
  frame_text_ = BracketText(bracket, done_, std::max(total_, done_));
  const double seconds = stopwatch_.Seconds();
  if (done_ < total_ && !bracket.placed) {  // how long a person takes, nobody knows
    const double left =
        seconds / static_cast<double>(done_ - before_) * static_cast<double>(total_ - done_);
    frame_text_ += ", " + TimeLeft(left);
  }
  Show(frame_text_);
}

void CaptureDisplay::OnGuidance(const nodes::Guidance& guidance) {
  const std::lock_guard<std::mutex> lock(mutex_);
  guidance_text_ = GuidanceText(guidance);
  Show(guidance_text_);
}

void CaptureDisplay::OnVerdict(const nodes::Verdict& verdict) {
  if (!verdict.words.empty()) OnLine(verdict.words);
}

void CaptureDisplay::OnEstimate(const nodes::Estimate& estimate) {
  const std::lock_guard<std::mutex> lock(mutex_);
  estimates_.push_back(estimate);
  std::string text = "estimate after " + std::to_string(estimate.keyframes) + ": " +
                     Lights(estimate) + ", " + Residual(estimate);
  for (const nodes::LightNow& light : estimate.lights) text += "; " + LightText(light);
  Show(text);
}

void CaptureDisplay::OnLine(const std::string& line) {
  const std::lock_guard<std::mutex> lock(mutex_);
  shown_.insert(line);
  if (!terminal_) return Show(line);
  Erase();
  std::fprintf(stderr, "%s\n", Printable(line).c_str());
  Draw();
}

bool CaptureDisplay::Showed(const std::string& line) {
  const std::lock_guard<std::mutex> lock(mutex_);
  return shown_.contains(line);
}

void CaptureDisplay::End(bool real_time) {
  const std::lock_guard<std::mutex> lock(mutex_);
  drawn_ = 0;
  if (!real_time || paced_ == 0) return;
  std::fprintf(stderr, "%s\n", PaceText(pace_, paced_, stopwatch_.Seconds()).c_str());
  std::fflush(stderr);
}

void CaptureDisplay::Show(const std::string& event) {
  if (terminal_) {
    Erase();
    Draw();
  } else {
    std::fprintf(stderr, "%s\n", Printable(event).c_str());
  }
  std::fflush(stderr);
}

void CaptureDisplay::Erase() {
  for (; drawn_ > 0; --drawn_) std::fputs("\033[A\r\033[K", stderr);
}

void CaptureDisplay::Draw() {
  const std::size_t columns = TerminalColumns() - 1;
  const auto line = [&](const std::string& text) {
    std::fprintf(stderr, "%s\n", Cut(Printable(text), columns).c_str());
    ++drawn_;
  };
  if (!frame_text_.empty()) line(frame_text_);
  if (!guidance_text_.empty()) line(guidance_text_);
  if (estimates_.empty()) return;
  const nodes::Estimate& now = estimates_.back();
  line("after " + std::to_string(now.keyframes) + ": " + Lights(now) + ", " + Residual(now));
  for (const nodes::LightNow& light : now.lights) line("  " + LightText(light));
}

}  // namespace turnlight::app
