#include "tests/rig/serial/transcript.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <sstream>
#include <vector>

#include "base/format.h"

namespace turnlight::rig::serial {
namespace {

std::string MotionName(TableMotion motion) {
  switch (motion) {
    case TableMotion::kIdle:
      return "idle";
    case TableMotion::kMoving:
      return "moving";
    case TableMotion::kUnhomed:
      return "unhomed";
    case TableMotion::kFault:
      return "fault";
  }
  return "";
}

// How what arrives is cut: whole reads, one byte at a time, each line at a place, or lines
// together.
struct Split {
  std::size_t at = 0;  // 0: not
  bool bytes = false, together = false;
};

struct Expected {
  std::string kind, text;  // text: between quotes
  std::optional<double> position_deg;
};

Expected ParseExpected(const std::string& line) {
  Expected expected;
  const std::size_t quote = line.find('\'');
  if (quote != line.npos) expected.text = line.substr(quote + 1, line.rfind('\'') - quote - 1);
  std::istringstream words(line.substr(0, quote));
  words >> expected.kind;
  if (double position_deg = 0.0; words >> position_deg) expected.position_deg = position_deg;
  return expected;
}

bool Fits(const Expected& expected, const StageEvent& event) {
  const std::string words = EventInWords(event);
  if (words.substr(0, words.find(' ')) != expected.kind) return false;
  if (words.find(expected.text) == words.npos) return false;
  const auto* report = std::get_if<StageReport>(&event);
  if (report != nullptr && (report->age < DeviceTime::zero() ||
                            report->fault.empty() != (report->motion == TableMotion::kIdle ||
                                                      report->motion == TableMotion::kMoving)))
    return false;
  return !expected.position_deg ||
         (report != nullptr && std::abs(report->position_deg - *expected.position_deg) < 1e-6);
}

bool IsMoving(const StageEvent& event) {
  const auto* report = std::get_if<StageReport>(&event);
  return report != nullptr && report->motion == TableMotion::kMoving;
}

class Player {
 public:
  Player(Conversation conversation, Split split)
      : conversation_(std::move(conversation)), split_(split) {}

  // Empty, or what is wrong.
  std::string Play(const std::string& line) {
    const char kind = line.front();
    const std::string rest = line.size() > 2 ? line.substr(2) : "";
    if (kind == '<') {
      arriving_ += conversation_.received(rest) + "\r\n";
      if (!split_.together) Deliver();
      return "";
    }
    Deliver();
    switch (kind) {
      case '>':
        return PlaySent(rest);
      case '+':
        Wait(std::chrono::milliseconds(std::stoi(rest)));
        return "";
      case '!':
        return PlayCall(rest);
      case '=':
        return PlayEvent(rest);
      case '.':
        return PlayEnd();
      default:
        return "no line of a script";
    }
  }

 private:
  void Take() {
    output_ += conversation_.protocol->TakeOutput();
    for (std::size_t end; (end = output_.find('\n')) != output_.npos; output_.erase(0, end + 1)) {
      std::string line = output_.substr(0, end);
      if (line.ends_with('\r')) line.pop_back();
      sent_.push_back(conversation_.sent(line));
    }
    for (StageEvent& event : conversation_.protocol->TakeEvents())
      events_.push_back(std::move(event));
  }

  void Deliver() {
    std::size_t in_line = 0;
    std::string chunk;
    for (const char byte : arriving_) {
      chunk += byte;
      ++in_line;
      if (byte == '\n') in_line = 0;
      if (split_.bytes || (split_.at != 0 && in_line == split_.at)) Receive(chunk);
    }
    Receive(chunk);
    arriving_.clear();
  }

  void Receive(std::string& chunk) {
    if (chunk.empty()) return;
    conversation_.protocol->Pass(DeviceTime::zero());
    Take();
    conversation_.protocol->Receive(chunk);
    chunk.clear();
    Take();
  }

  void Wait(DeviceTime left) {
    while (left > DeviceTime::zero()) {
      const DeviceTime step = std::min(left, conversation_.protocol->Until());
      conversation_.protocol->Pass(step);
      Take();
      left -= step;
    }
  }

  std::string PlaySent(const std::string& wanted) {
    if (sent_.empty()) return "nothing was sent" + Rest();
    const std::string line = sent_.front();
    sent_.pop_front();
    return line == wanted ? "" : "sent was '" + line + "'" + Rest();
  }

  std::string PlayCall(const std::string& call) {
    StageProtocol& protocol = *conversation_.protocol;
    if (call == "connect") {
      protocol.Connect();
    } else if (call == "home") {
      protocol.Home();
    } else if (call == "halt") {
      protocol.Halt();
    } else if (call.starts_with("move ")) {
      protocol.MoveTo(std::stod(call.substr(5)));
    } else {
      return "no call";
    }
    Take();
    return "";
  }

  std::string PlayEvent(const std::string& line) {
    const Expected expected = ParseExpected(line);
    if (expected.kind != "moving") DropMoving();
    while (events_.size() > 1 && IsMoving(events_.front()) && !Fits(expected, events_.front()))
      events_.pop_front();
    if (events_.empty()) return "nothing happened" + Rest();
    const StageEvent event = events_.front();
    events_.pop_front();
    return Fits(expected, event) ? "" : "what happened: " + EventInWords(event) + Rest();
  }

  std::string PlayEnd() {
    DropMoving();
    return sent_.empty() && events_.empty() && output_.empty() ? "" : "there is more" + Rest();
  }

  void DropMoving() {
    while (!events_.empty() && IsMoving(events_.front())) events_.pop_front();
  }

  std::string Rest() const {
    std::string text;
    for (const std::string& line : sent_) text += "; sent '" + line + "'";
    for (const StageEvent& event : events_) text += "; " + EventInWords(event);
    return text;
  }

  Conversation conversation_;
  const Split split_;
  std::string output_, arriving_;
  std::deque<std::string> sent_;
  std::deque<StageEvent> events_;
};

std::vector<std::string> LinesOf(std::string_view script) {
  std::vector<std::string> lines;
  std::istringstream stream{std::string(script)};
  for (std::string line; std::getline(stream, line);) {
    line.erase(0, std::min(line.find_first_not_of(' '), line.size()));
    lines.push_back(line);
  }
  lines.emplace_back(".");
  return lines;
}

}  // namespace

std::string PlayTranscript(const std::function<Conversation()>& begin, std::string_view script) {
  const std::vector<std::string> lines = LinesOf(script);
  std::size_t longest = 1;
  for (const std::string& line : lines) longest = std::max(longest, line.size() + 4);
  std::vector<Split> splits = {{}, {.bytes = true}, {.together = true}};
  for (std::size_t at = 1; at < longest; ++at) splits.push_back({.at = at});
  for (const Split& split : splits) {
    Player player(begin(), split);
    for (std::size_t number = 0; number < lines.size(); ++number) {
      const std::string& line = lines[number];
      if (line.empty() || line.front() == '#') continue;
      const std::string wrong = player.Play(line);
      if (!wrong.empty())
        return Format("line %zu, '%s': ", number + 1, line.c_str()) + wrong +
               Format(" (split at %zu%s%s)", split.at, split.bytes ? ", every byte" : "",
                      split.together ? ", together" : "");
    }
  }
  return "";
}

std::string EventInWords(const StageEvent& event) {
  if (const auto* report = std::get_if<StageReport>(&event))
    return MotionName(report->motion) + Format(" %.5f", report->position_deg) +
           (report->fault.empty() ? "" : " '" + report->fault + "'");
  if (const auto* failed = std::get_if<StageFailed>(&event))
    return (failed->for_good ? "for-good '" : "failed '") + failed->text + "'";
  if (const auto* note = std::get_if<StageNote>(&event)) return "note '" + note->text + "'";
  const StageIdentified& stage = std::get<StageIdentified>(event);
  return "identified '" + stage.identity.vendor + ", " + stage.identity.model + ", " +
         stage.identity.serial + "'";
}

}  // namespace turnlight::rig::serial
