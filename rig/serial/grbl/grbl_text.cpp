#include "rig/serial/grbl/grbl_text.h"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

namespace turnlight::rig::serial::grbl {
namespace {

constexpr std::size_t kMaxAxes = 9;

std::vector<std::string_view> Split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

// Decimal, with nothing before or after it but a sign.
std::optional<double> ParseNumber(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

std::optional<int> ParseInt(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<std::vector<double>> ParseNumbers(std::string_view text) {
  std::vector<double> numbers;
  for (const std::string_view part : Split(text, ',')) {
    const auto number = ParseNumber(part);
    if (!number || numbers.size() == kMaxAxes) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

bool TakePrefix(std::string_view& text, std::string_view prefix) {
  if (text.substr(0, prefix.size()) != prefix) return false;
  text.remove_prefix(prefix.size());
  return true;
}

// What stands between these, or nothing.
std::optional<std::string_view> Within(std::string_view line, char first, char last) {
  if (line.size() < 2 || line.front() != first || line.back() != last) return std::nullopt;
  return line.substr(1, line.size() - 2);
}

bool ParseState(std::string_view text, StatusReport& report) {
  static constexpr std::array<std::pair<std::string_view, State>, 10> kStates{
      {{"Idle", State::kIdle},
       {"Run", State::kRun},
       {"Hold", State::kHold},
       {"Jog", State::kJog},
       {"Alarm", State::kAlarm},
       {"Door", State::kDoor},
       {"Check", State::kCheck},
       {"Home", State::kHome},
       {"Sleep", State::kSleep},
       {"Tool", State::kTool}}};
  report.state_word = text;
  const std::size_t colon = text.find(':');
  if (colon != std::string_view::npos) {
    report.substate = ParseInt(text.substr(colon + 1));
    if (!report.substate) return false;
  }
  for (const auto& [word, state] : kStates)
    if (text.substr(0, colon) == word) {
      report.state = state;
      return true;
    }
  return false;
}

struct Code {
  int number;
  const char* words;
};

// The meanings in the firmware's lists, in short.
constexpr Code kErrors[] = {{1, "expected a command letter"},
                            {2, "bad number format"},
                            {3, "invalid $ statement"},
                            {4, "negative value"},
                            {5, "homing is not enabled: setting $22"},
                            {6, "step pulse below 3 us"},
                            {7, "EEPROM read failed, defaults restored"},
                            {8, "not idle: a $ command needs that"},
                            {9, "locked out during an alarm or a jog"},
                            {10, "soft limits need homing"},
                            {11, "line longer than its buffer"},
                            {12, "step rate above 30 kHz"},
                            {13, "safety door opened"},
                            {14, "build info or start-up line too long"},
                            {15, "jog target beyond the travel"},
                            {16, "invalid jog command"},
                            {17, "laser mode needs PWM"},
                            {18, "no homing cycle is set"},
                            {20, "unsupported command"},
                            {21, "two commands of one modal group"},
                            {22, "no feed rate"},
                            {23, "command needs a whole number"},
                            {24, "two commands want the axis words"},
                            {25, "word repeated"},
                            {26, "no axis words"},
                            {27, "bad line number"},
                            {28, "a value is missing"},
                            {29, "unsupported coordinate system"},
                            {30, "G53 needs G0 or G1"},
                            {31, "axis words without use"},
                            {32, "no axis words in the plane"},
                            {33, "invalid target"},
                            {34, "bad radius"},
                            {35, "arc offsets missing"},
                            {36, "unused words"},
                            {37, "tool offset on another axis"},
                            {38, "tool number too large"},
                            {39, "value out of range"},
                            {50, "emergency stop is active"},
                            {60, "SD card failed"},
                            {79, "not allowed while an alarm is critical"}};
constexpr Code kAlarms[] = {{1, "hard limit, position lost"},
                            {2, "target beyond the soft limits"},
                            {3, "reset in motion, position lost"},
                            {4, "probe in the wrong state"},
                            {5, "probe without contact"},
                            {6, "homing was reset"},
                            {7, "homing stopped by the safety door"},
                            {8, "homing: the switch did not clear on pull-off"},
                            {9, "homing: no switch found"},
                            {10, "emergency stop, or homing of a second motor failed"},
                            {11, "homing is required"},
                            {12, "limit switch held"},
                            {13, "probe is protecting"},
                            {14, "spindle did not reach its speed"},
                            {15, "homing of an axis with several motors failed"},
                            {16, "power-on self-test failed"},
                            {17, "motor fault"}};

template <std::size_t N>
std::string Words(const char* kind, int code, const Code (&codes)[N]) {
  const std::string text = kind + std::to_string(code);
  for (const Code& known : codes)
    if (known.number == code) return text + " (" + known.words + ")";
  return text + " (not in the firmware's list)";
}

// The number after a prefix; words in its place give 0.
std::optional<int> CodeAfter(std::string_view line, std::string_view prefix) {
  if (!TakePrefix(line, prefix) || line.empty()) return std::nullopt;
  return ParseInt(line).value_or(0);
}

}  // namespace

std::optional<StatusReport> ParseStatus(std::string_view line) {
  const auto inner = Within(line, '<', '>');
  if (!inner) return std::nullopt;
  const auto fields = Split(*inner, '|');
  StatusReport report;
  if (!ParseState(fields.front(), report)) return std::nullopt;
  for (std::size_t i = 1; i < fields.size(); ++i) {
    std::string_view field = fields[i];
    const bool machine = field.substr(0, 5) == "MPos:";
    if (machine || field.substr(0, 5) == "WPos:") {
      const auto position = ParseNumbers(field.substr(5));
      if (!position || !report.position.empty()) return std::nullopt;
      report.machine = machine;
      report.position = *position;
    } else if (TakePrefix(field, "WCO:")) {
      report.work_offset = ParseNumbers(field);
      if (!report.work_offset) return std::nullopt;
    }
  }
  if (report.position.empty()) return std::nullopt;
  return report;
}

std::optional<Banner> ParseBanner(std::string_view line) {
  const std::size_t space = line.find(' ');
  if (space == std::string_view::npos) return std::nullopt;
  const std::string_view name = line.substr(0, space);
  if (name != "Grbl" && name != "GrblHAL" && name != "grblHAL") return std::nullopt;
  const std::string_view rest = line.substr(space + 1);
  if (rest.find('[') == std::string_view::npos) return std::nullopt;
  return Banner{std::string(name), std::string(rest.substr(0, rest.find_first_of(" [")))};
}

std::optional<Version> ParseVersion(std::string_view line) {
  auto inner = Within(line, '[', ']');
  if (!inner || !TakePrefix(*inner, "VER:")) return std::nullopt;
  const std::size_t colon = inner->find(':');
  return Version{std::string(inner->substr(0, colon)),
                 colon == std::string_view::npos ? "" : std::string(inner->substr(colon + 1))};
}

std::optional<Setting> ParseSetting(std::string_view line) {
  if (!TakePrefix(line, "$")) return std::nullopt;
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos) return std::nullopt;
  const auto number = ParseInt(line.substr(0, equals));
  if (!number || *number < 0) return std::nullopt;
  std::string_view value = line.substr(equals + 1);
  // "10 (step pulse, usec)"
  if (const std::size_t bracket = value.find('('); bracket != std::string_view::npos && bracket > 0)
    value = value.substr(0, bracket);
  while (!value.empty() && value.back() == ' ') value.remove_suffix(1);
  while (!value.empty() && value.front() == ' ') value.remove_prefix(1);
  return Setting{*number, std::string(value)};
}

std::optional<double> SettingNumber(const Settings& settings, int number) {
  const auto found = settings.find(number);
  return found == settings.end() ? std::nullopt : ParseNumber(found->second);
}

std::optional<StartupLine> ParseStartupLine(std::string_view line) {
  if (!TakePrefix(line, "$N")) return std::nullopt;
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos) return std::nullopt;
  const auto number = ParseInt(line.substr(0, equals));
  if (!number) return std::nullopt;
  return StartupLine{*number, std::string(line.substr(equals + 1))};
}

bool MovesAnAxis(std::string_view block) {
  std::string upper;
  for (const char c : block)
    if (c != ' ') upper += static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
  if (upper.substr(0, 2) == "$H" || upper.substr(0, 2) == "$J") return true;
  if (upper.find_first_of("XYZABCUVW") != std::string::npos) return true;
  for (std::size_t at = upper.find('G'); at != std::string::npos; at = upper.find('G', at + 1)) {
    const std::string number =
        upper.substr(at + 1, upper.find_first_not_of("0123456789.", at + 1) - at - 1);
    const double code = ParseNumber(number).value_or(-1.0);
    // To a stored place; the others of group 1 need an axis word, which was looked for.
    if (code == 28.0 || code == 30.0) return true;
  }
  return false;
}

std::optional<std::vector<double>> ParseOffset(std::string_view line) {
  const auto inner = Within(line, '[', ']');
  if (!inner) return std::nullopt;
  const std::size_t colon = inner->find(':');
  if (colon == std::string_view::npos) return std::nullopt;
  const std::string_view name = inner->substr(0, colon);
  if (name != "G92" && (name.size() < 3 || name.substr(0, 2) != "G5")) return std::nullopt;
  return ParseNumbers(inner->substr(colon + 1));
}

std::optional<int> ParseError(std::string_view line) { return CodeAfter(line, "error:"); }
std::optional<int> ParseAlarm(std::string_view line) { return CodeAfter(line, "ALARM:"); }
std::string ErrorWords(int code) { return Words("error:", code, kErrors); }
std::string AlarmWords(int code) { return Words("ALARM:", code, kAlarms); }

}  // namespace turnlight::rig::serial::grbl
