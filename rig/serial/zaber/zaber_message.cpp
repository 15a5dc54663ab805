#include "rig/serial/zaber/zaber_message.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <numeric>
#include <vector>

#include "base/format.h"

namespace turnlight::rig::serial::zaber {
namespace {

struct Words {
  std::string_view name, words;
};

// In the manual's order: a reply shows the first of those that are set.
constexpr std::array kFlags = {
    Words{"FF", "critical system error"},
    Words{"FN", "peripheral not supported"},
    Words{"FZ", "peripheral inactive"},
    Words{"FH", "hardware emergency stop"},
    Words{"FV", "overvoltage or undervoltage, the driver is off"},
    Words{"FO", "the driver is off"},
    Words{"FC", "current inrush error"},
    Words{"FM", "motor temperature error"},
    Words{"FD", "the driver is off by a fault"},
    Words{"FQ", "encoder error"},
    Words{"FI", "index error"},
    Words{"FA", "analogue encoder out of step"},
    Words{"FR", "overdrive limit exceeded"},
    Words{"FS", "stalled and stopped"},
    Words{"FB", "stream bounds error"},
    Words{"FP", "deviation from an interpolated path"},
    Words{"FE", "limit error"},
    Words{"FT", "excessive twist"},
    Words{"WL", "unexpected limit trigger"},
    Words{"WV", "supply voltage out of range"},
    Words{"WT", "controller temperature high"},
    Words{"WS", "stalled and recovered"},
    Words{"WM", "displaced when stationary"},
    Words{"WP", "invalid calibration type"},
    Words{"WR", "no reference position"},
    Words{"WH", "not homed since it was switched on"},
    Words{"NC", "under manual control"},
    Words{"NI", "movement interrupted"},
    Words{"ND", "stream discontinuity"},
    Words{"NR", "value rounded"},
    Words{"NT", "value truncated"},
    Words{"NU", "a setting's update is pending"},
    Words{"NJ", "joystick calibrating"},
    Words{"NB", "firmware update mode"},
};

constexpr std::array kRejections = {
    Words{"AGAIN", "it cannot be done right now"},
    Words{"AXISONLY", "the command is for one axis"},
    Words{"BADAXIS", "there is no axis of this number"},
    Words{"BADCHECKSUM", "the command came garbled"},
    Words{"BADCOMMAND", "the command or setting is not known"},
    Words{"BADDATA", "a value is missing or out of range"},
    Words{"BADMESSAGEID", "the message id is out of range"},
    Words{"DEVICEONLY", "the command is for the device as a whole"},
    Words{"DRIVERDISABLED", "the axis's driver is off"},
    Words{"FULL", "no room for it"},
    Words{"INACTIVE", "the axis is inactive"},
    Words{"LOCKSTEP", "the axis is locked to another"},
    Words{"NOACCESS", "the device's access level forbids it"},
    Words{"NOTSUPPORTED", "the device does not support it"},
    Words{"PARKED", "the axis is parked"},
    Words{"REMOTE", "not while the device is controlled remotely"},
    Words{"STATUSBUSY", "not while the axis is moving"},
};

template <std::size_t kCount>
std::string InWords(const std::array<Words, kCount>& table, std::string_view name) {
  const auto found =
      std::find_if(table.begin(), table.end(), [&](const Words& row) { return row.name == name; });
  std::string text(name);
  return found == table.end() ? text : text + ": " + std::string(found->words);
}

bool IsDigit(char byte) { return byte >= '0' && byte <= '9'; }

int HexDigit(char byte) {
  if (IsDigit(byte)) return byte - '0';
  if (byte >= 'A' && byte <= 'F') return byte - 'A' + 10;
  if (byte >= 'a' && byte <= 'f') return byte - 'a' + 10;
  return -1;
}

// Takes words off the front of a line.
class WordReader {
 public:
  explicit WordReader(std::string_view text) : rest_(text) { SkipSpaces(); }

  std::string_view Peek() const { return rest_.substr(0, rest_.find(' ')); }
  std::string_view Next() {
    const std::string_view word = Peek();
    rest_.remove_prefix(word.size());
    SkipSpaces();
    return word;
  }
  // The next word as a number of one or two digits.
  std::optional<int> Number() {
    const std::string_view word = Peek();
    if (word.empty() || word.size() > 2 || !std::all_of(word.begin(), word.end(), IsDigit))
      return std::nullopt;
    int value = 0;
    std::from_chars(word.data(), word.data() + word.size(), value);
    Next();
    return value;
  }
  std::string_view rest() const { return rest_; }

 private:
  void SkipSpaces() { rest_.remove_prefix(std::min(rest_.find_first_not_of(' '), rest_.size())); }

  std::string_view rest_;
};

std::string_view WithoutTrailingSpaces(std::string_view text) {
  return text.substr(0, text.find_last_not_of(' ') + 1);
}

// The content without its checksum; nothing if that is wrong. The colon is reserved for it.
std::optional<std::string_view> CheckedContent(std::string_view content) {
  const std::size_t colon = content.rfind(':');
  if (colon == content.npos) return content;
  const std::string_view digits = content.substr(colon + 1);
  if (digits.size() != 2 || HexDigit(digits[0]) < 0 || HexDigit(digits[1]) < 0) return std::nullopt;
  content = content.substr(0, colon);
  if (HexDigit(digits[0]) * 16 + HexDigit(digits[1]) != Checksum(content)) return std::nullopt;
  return content;
}

// "IDLE --", of replies and alerts.
bool ReadState(WordReader& words, Message& message) {
  const std::string_view state = words.Next();
  message.busy = state == "BUSY";
  if (!message.busy && state != "IDLE") return false;
  message.flag = words.Next();
  return message.flag.size() == 2;
}

}  // namespace

std::optional<Message> ParseMessage(std::string_view line) {
  line = WithoutTrailingSpaces(line);
  if (line.empty()) return std::nullopt;
  Message message;
  switch (line.front()) {
    case '@':
      message.kind = MessageKind::kReply;
      break;
    case '!':
      message.kind = MessageKind::kAlert;
      break;
    case '#':
      message.kind = MessageKind::kInfo;
      break;
    default:
      return std::nullopt;
  }
  const auto content = CheckedContent(line.substr(1));
  if (!content) return std::nullopt;
  WordReader words(*content);
  const auto device = words.Number(), axis = words.Number();
  if (!device || !axis) return std::nullopt;
  message.device = *device;
  message.axis = *axis;
  if (message.kind != MessageKind::kAlert) message.id = words.Number();
  if (message.kind == MessageKind::kReply) {
    const std::string_view verdict = words.Next();
    message.rejected = verdict == "RJ";
    if (!message.rejected && verdict != "OK") return std::nullopt;
  }
  if (message.kind != MessageKind::kInfo && !ReadState(words, message)) return std::nullopt;
  std::string_view data = WithoutTrailingSpaces(words.rest());
  message.continues = data.ends_with('\\');
  if (message.continues) data.remove_suffix(1);
  message.data = WithoutTrailingSpaces(data);
  return message;
}

std::string FormatCommand(int device, int axis, int id, std::string_view command) {
  std::string content = Format("%d %d %d", device, axis, id);
  if (!command.empty()) content += " " + std::string(command);
  return "/" + content + Format(":%02X\n", Checksum(content));
}

std::uint8_t Checksum(std::string_view content) {
  unsigned sum = 0;
  for (const char byte : content) sum += static_cast<unsigned char>(byte);
  return static_cast<std::uint8_t>(-sum);
}

FlagMeaning MeaningOf(std::string_view flag) {
  if (flag == "--") return FlagMeaning::kNone;
  if (flag == "WR" || flag == "WH") return FlagMeaning::kUnhomed;
  if (flag == "NC" || flag == "NI") return FlagMeaning::kDisturbed;
  if (flag.starts_with('N') || flag == "WV" || flag == "WT" || flag == "WP")
    return FlagMeaning::kNotice;
  // All F, the other W, and what a later firmware may add: in doubt the frame is lost.
  return FlagMeaning::kFault;
}

std::string FlagInWords(std::string_view flag) { return InWords(kFlags, flag); }

std::string RejectionInWords(std::string_view reason) { return InWords(kRejections, reason); }

}  // namespace turnlight::rig::serial::zaber
