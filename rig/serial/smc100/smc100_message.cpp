#include "rig/serial/smc100/smc100_message.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>
#include <vector>

#include "base/format.h"

namespace turnlight::rig::serial::smc100 {
namespace {

using StateName = std::pair<unsigned, std::string_view>;
constexpr std::array kStateNames = {
    StateName{0x0a, "NOT REFERENCED from reset"},
    StateName{0x0b, "NOT REFERENCED from HOMING"},
    StateName{0x0c, "NOT REFERENCED from CONFIGURATION"},
    StateName{0x0d, "NOT REFERENCED from DISABLE"},
    StateName{0x0e, "NOT REFERENCED from READY"},
    StateName{0x0f, "NOT REFERENCED from MOVING"},
    StateName{0x10, "NOT REFERENCED, stage error or no parameters in memory"},
    StateName{0x11, "NOT REFERENCED from JOGGING"},
    StateName{0x14, "CONFIGURATION"},
    StateName{0x1e, "HOMING"},
    StateName{0x1f, "HOMING by the remote control"},
    StateName{0x28, "MOVING"},
    StateName{0x32, "READY from HOMING"},
    StateName{0x33, "READY from MOVING"},
    StateName{0x34, "READY from DISABLE"},
    StateName{0x35, "READY from JOGGING"},
    StateName{0x36, "READY with tracking"},
    StateName{0x37, "READY from TRACKING"},
    StateName{0x38, "READY with tracking from DISABLE"},
    StateName{0x3c, "DISABLE from READY"},
    StateName{0x3d, "DISABLE from MOVING"},
    StateName{0x3e, "DISABLE from JOGGING or TRACKING"},
    StateName{0x3f, "DISABLE with tracking"},
    StateName{0x46, "JOGGING or TRACKING"},
    StateName{0x47, "JOGGING from DISABLE, or TRACKING"},
};

// Bit by bit, from the lowest; those that are empty are not used.
constexpr std::array<std::string_view, 16> kErrorNames = {
    "negative end of run",
    "positive end of run",
    "peak current limit",
    "RMS current limit",
    "short circuit",
    "following error",
    "homing time-out",
    "wrong stage or no parameters in memory",
    "supply voltage too low",
    "output power exceeded",
    "driver fault",
    "driver overheating",
    "",
    "",
    "",
    "",
};

using CommandError = std::pair<char, std::string_view>;
constexpr std::array kCommandErrors = {
    CommandError{'A', "unknown message code or controller address"},
    CommandError{'B', "wrong controller address"},
    CommandError{'C', "parameter missing or out of range"},
    CommandError{'D', "command not allowed"},
    CommandError{'E', "homing has already begun"},
    CommandError{'F', "stage name unknown"},
    CommandError{'G', "displacement out of limits"},
    CommandError{'H', "not allowed in state NOT REFERENCED"},
    CommandError{'I', "not allowed in state CONFIGURATION"},
    CommandError{'J', "not allowed in state DISABLE"},
    CommandError{'K', "not allowed in state READY"},
    CommandError{'L', "not allowed in state HOMING"},
    CommandError{'M', "not allowed in state MOVING"},
    CommandError{'N', "position out of the software limits"},
    CommandError{'P', "not allowed in state TRACKING"},
    CommandError{'S', "communication time-out"},
    CommandError{'U', "error in the controller's memory"},
    CommandError{'V', "error while the command was executed"},
    CommandError{'W', "not allowed for the stepper version"},
    CommandError{'X', "not allowed for the DC version"},
};

// How the names of Newport's linear stages begin that these controllers drive.
constexpr std::array<std::string_view, 15> kLinearStages = {"TRA", "TRB", "LTA", "LTS", "MFA",
                                                            "MFN", "ILS", "UTS", "UTM", "GTS",
                                                            "IMS", "MTN", "VP",  "XMS", "AG-LS"};

bool IsSpace(char byte) { return byte == ' '; }

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && IsSpace(text.front())) text.remove_prefix(1);
  while (!text.empty() && IsSpace(text.back())) text.remove_suffix(1);
  return text;
}

char UpperLetter(char byte) {
  return byte >= 'a' && byte <= 'z' ? static_cast<char>(byte - 'a' + 'A') : byte;
}

template <typename Table, typename Key>
std::string_view NameOf(const Table& table, Key key, std::string_view otherwise) {
  const auto found =
      std::find_if(table.begin(), table.end(), [&](const auto& row) { return row.first == key; });
  return found == table.end() ? otherwise : found->second;
}

}  // namespace

std::optional<Reply> ParseReply(std::string_view line) {
  line = Trimmed(line);
  Reply reply;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), reply.address);
  if (error != std::errc() || reply.address < 1 || reply.address > 31) return std::nullopt;
  line = Trimmed(line.substr(static_cast<std::size_t>(end - line.data())));
  if (line.size() < 2) return std::nullopt;
  for (const char letter : {UpperLetter(line[0]), UpperLetter(line[1])}) {
    if (letter < 'A' || letter > 'Z') return std::nullopt;
    reply.command += letter;
  }
  reply.value = Trimmed(line.substr(2));
  return reply;
}

std::optional<double> ParseValue(std::string_view text) {
  std::string digits(text);
  std::erase_if(digits, IsSpace);
  const char* begin = digits.data();
  const char* const end = begin + digits.size();
  if (begin != end && *begin == '+') ++begin;
  double value = 0.0;
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string FormatAngle(double angle_deg) {
  std::array<char, 400> digits;  // a double has at most 309 before its point
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), angle_deg,
                                          std::chars_format::fixed, 5);
  std::string text(digits.data(), error == std::errc() ? end : digits.data());
  return text == "-0.00000" ? "0.00000" : text;
}

std::optional<ControllerState> ParseState(std::string_view value) {
  unsigned code = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), code, 16);
  if (value.size() != 6 || error != std::errc() || end != value.data() + value.size())
    return std::nullopt;
  return ControllerState{code >> 8, code & 0xff};
}

StateKind KindOf(unsigned state) {
  if (state >= 0x0a && state <= 0x11) return StateKind::kUnreferenced;
  if (state == 0x14) return StateKind::kConfiguration;
  if (state == 0x1e || state == 0x1f) return StateKind::kHoming;
  if (state == 0x28) return StateKind::kMoving;
  if (state >= 0x32 && state <= 0x35) return StateKind::kReady;
  if (state >= 0x3c && state <= 0x3f) return StateKind::kDisabled;
  return StateKind::kOther;
}

std::string StateInWords(unsigned state) {
  return Format("%02X, ", state) + std::string(NameOf(kStateNames, state, "not in the manual"));
}

std::string ErrorsInWords(unsigned errors) {
  std::vector<std::string> words;
  for (unsigned bit = 0; bit < kErrorNames.size(); ++bit) {
    if ((errors >> bit & 1u) == 0) continue;
    words.push_back(kErrorNames[bit].empty() ? Format("error bit %u", bit)
                                             : std::string(kErrorNames[bit]));
  }
  return Listed(words);
}

std::string CommandErrorInWords(char code) {
  return std::string(1, code) + ", " +
         std::string(NameOf(kCommandErrors, code, "not in the manual"));
}

bool IsLinearStage(std::string_view name) {
  std::string upper(name);
  std::transform(upper.begin(), upper.end(), upper.begin(), UpperLetter);
  return std::any_of(kLinearStages.begin(), kLinearStages.end(),
                     [&](std::string_view prefix) { return upper.starts_with(prefix); });
}

}  // namespace turnlight::rig::serial::smc100
