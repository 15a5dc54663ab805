#include "rig/serial/line_protocol.h"

#include <algorithm>
#include <utility>

#include "base/format.h"

namespace turnlight::rig::serial {
namespace {

constexpr std::size_t kBadLinesAllowed = 4;
constexpr DeviceTime kBadLineMemory = std::chrono::minutes(1);
constexpr std::size_t kQuotedLength = 40;
// Flow control, where the port leaves it in: no text.
constexpr char kXon = 0x11, kXoff = 0x13;

}  // namespace

void LineProtocol::Connect() {
  splitter_.Reset();
  splitter_.TakeBad();
  now_ = due_ = {};
  over_ = false;
  bad_lines_.clear();
  last_bad_line_.clear();
  output_.clear();
  events_.clear();
  Begin();
}

void LineProtocol::Receive(std::string_view bytes) {
  if (over_) return;
  std::string text(bytes);
  std::erase_if(text, [](char byte) { return byte == kXon || byte == kXoff; });
  for (const std::string& line : splitter_.Take(text)) {
    HandleLine(line);
    if (over_) return;
  }
  for (std::size_t bad = splitter_.TakeBad(); bad > 0 && !over_; --bad) BadLine({});
}

void LineProtocol::Pass(DeviceTime elapsed) {
  now_ += std::max(elapsed, DeviceTime::zero());
  if (over_ || now_ < due_) return;
  // Asked again if the protocol sets no other time: never twice in a millisecond.
  WakeIn(std::chrono::seconds(1));
  HandleTime();
}

DeviceTime LineProtocol::Until() const {
  if (over_) return std::chrono::seconds(1);
  return std::max<DeviceTime>(due_ - now_, std::chrono::milliseconds(1));
}

std::string LineProtocol::TakeOutput() { return std::exchange(output_, {}); }

std::vector<StageEvent> LineProtocol::TakeEvents() { return std::exchange(events_, {}); }

void LineProtocol::Write(std::string_view bytes) { output_ += bytes; }

void LineProtocol::BadLine(std::string_view line) {
  if (!line.empty())
    last_bad_line_ = "'" + std::string(line.substr(0, kQuotedLength)) +
                     (line.size() > kQuotedLength ? "...'" : "'");
  std::erase_if(bad_lines_, [&](DeviceTime time) { return now_ - time > kBadLineMemory; });
  bad_lines_.push_back(now_);
  if (bad_lines_.size() > kBadLinesAllowed)
    Fail(
        Format("%zu lines within a minute make no sense%s%s: wrong baud rate, wrong protocol, or a "
               "disturbed cable",
               bad_lines_.size(), last_bad_line_.empty() ? "" : ", the last ",
               last_bad_line_.c_str()),
        false);
}

void LineProtocol::Note(std::string text) { events_.emplace_back(StageNote{std::move(text)}); }

void LineProtocol::Report(TableMotion motion, double position_deg, std::string fault,
                          DeviceTime asked) {
  events_.emplace_back(StageReport{motion, position_deg, std::move(fault), now_ - asked});
}

void LineProtocol::Fail(std::string text, bool for_good) {
  if (over_) return;
  over_ = true;
  events_.emplace_back(StageFailed{std::move(text), for_good});
}

}  // namespace turnlight::rig::serial
