// What protocols that talk in lines have in common: bytes become lines, time is summed up, output
// and events wait to be taken, and a link that gives nonsense is given up.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "rig/serial/line_splitter.h"
#include "rig/serial/stage_protocol.h"

namespace turnlight::rig::serial {

class LineProtocol : public StageProtocol {
 public:
  void Connect() final;
  void Receive(std::string_view bytes) final;
  void Pass(DeviceTime elapsed) final;
  DeviceTime Until() const final;
  std::string TakeOutput() final;
  std::vector<StageEvent> TakeEvents() final;

 protected:
  explicit LineProtocol(std::size_t max_line) : splitter_(max_line) {}

  // A protocol's part. The conversation begins; everything of an earlier one is forgotten.
  virtual void Begin() = 0;
  virtual void HandleLine(const std::string& line) = 0;
  // The time given to WakeIn is over, once.
  virtual void HandleTime() = 0;

  DeviceTime now() const { return now_; }  // since the link was opened
  bool over() const { return over_; }
  // HandleTime is due so long from now, instead of what was due before.
  void WakeIn(DeviceTime wait) { due_ = now_ + wait; }

  void Write(std::string_view bytes);
  // A line that no controller of this kind sends. Five in a minute end the conversation: a wrong
  // baud rate or a bad cable garbles lines without end, a disturbance only a few.
  void BadLine(std::string_view line);
  // The line that was bad last, shortened, in quotes; empty if none had text.
  const std::string& last_bad_line() const { return last_bad_line_; }

  void Note(std::string text);
  // asked: when the question was sent whose answer this is.
  void Report(TableMotion motion, double position_deg, std::string fault, DeviceTime asked);
  void Tell(StageIdentified identified) { events_.emplace_back(std::move(identified)); }
  void Fail(std::string text, bool for_good);

 private:
  LineSplitter splitter_;
  DeviceTime now_{}, due_{};
  bool over_ = true;  // until Connect
  std::vector<DeviceTime> bad_lines_;
  std::string last_bad_line_;
  std::string output_;
  std::vector<StageEvent> events_;
};

}  // namespace turnlight::rig::serial
