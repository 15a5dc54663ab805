#include "rig/sim/stage/zaber_message.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>

#include "base/format.h"

namespace turnlight::rig::sim::stage {
namespace {

// A number of at most three digits.
std::optional<int> SmallNumber(const std::string& word) {
  if (word.empty() || word.size() > 3 || !std::all_of(word.begin(), word.end(), [](char c) {
        return std::isdigit(static_cast<unsigned char>(c));
      }))
    return std::nullopt;
  return std::atoi(word.c_str());
}

std::vector<std::string> Words(std::string_view text) {
  std::vector<std::string> words;
  std::string word;
  for (const char c : text) {
    if (c != ' ') {
      word += c;
    } else if (!word.empty()) {
      words.push_back(word);
      word.clear();
    }
  }
  if (!word.empty()) words.push_back(word);
  return words;
}

}  // namespace

std::string ZaberChecksum(std::string_view text) {
  unsigned sum = 0;
  for (const char c : text) sum += static_cast<unsigned char>(c);
  return Format("%02X", (0x100u - (sum & 0xffu)) & 0xffu);
}

std::optional<ZaberCommand> ReadZaberCommand(std::string_view line) {
  if (line.empty() || line.front() != '/') return std::nullopt;
  line.remove_prefix(1);
  if (const std::size_t colon = line.find(':'); colon != std::string_view::npos) {
    std::string given(line.substr(colon + 1));
    for (char& c : given) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    line = line.substr(0, colon);
    if (given != ZaberChecksum(line)) return std::nullopt;
  }
  ZaberCommand command;
  command.words = Words(line);
  for (int place = 0; place < 3 && !command.words.empty(); ++place) {
    const auto number = SmallNumber(command.words.front());
    if (!number) break;
    if (place == 0) command.device = *number;
    if (place == 1) command.axis = *number;
    if (place == 2) command.id = *number % 100;
    command.words.erase(command.words.begin());
  }
  return command;
}

}  // namespace turnlight::rig::sim::stage
