#include "rig/sim/stage/gcode.h"

#include <cmath>
#include <cstdlib>
#include <map>
#include <set>

namespace turnlight::rig::sim::stage {
namespace {

constexpr double kMmPerInch = 25.4;
constexpr int kNoMotion = 80;

// What a G word changes; words of one group exclude each other in a block.
enum class Group { kOneShot, kMotion, kPlane, kDistance, kFeedMode, kUnits, kOffset, kIgnored };

std::optional<Group> GroupOf(int g) {
  switch (g) {
    case 4:
    case 53:
      return Group::kOneShot;
    case 0:
    case 1:
    case kNoMotion:
      return Group::kMotion;
    case 17:
    case 18:
    case 19:
      return Group::kPlane;
    case 90:
    case 91:
      return Group::kDistance;
    case 93:
    case 94:
      return Group::kFeedMode;
    case 20:
    case 21:
      return Group::kUnits;
    case 54:
      return Group::kOffset;
    case 40:
    case 49:
      return Group::kIgnored;
    default:
      return std::nullopt;
  }
}

// The words of a block by what they are.
struct Sorted {
  std::set<int> g;
  std::optional<int> m;           // 3, 4 or 5
  std::map<char, double> values;  // F, S, P, axes
};

std::optional<GrblError> SortG(double value, std::set<Group>& groups, Sorted& sorted) {
  const int g = static_cast<int>(value);
  if (g != value) return GrblError::kUnsupportedCommand;
  const auto group = GroupOf(g);
  if (!group) return GrblError::kUnsupportedCommand;
  if (!groups.insert(*group).second) return GrblError::kModalGroupViolation;
  sorted.g.insert(g);
  return std::nullopt;
}

std::optional<GrblError> SortM(double value, Sorted& sorted) {
  if (value != std::floor(value)) return GrblError::kNotAnInteger;
  if (value == 9.0) return std::nullopt;  // coolant off: there is none
  if (value < 3.0 || value > 5.0) return GrblError::kUnsupportedCommand;
  if (sorted.m) return GrblError::kModalGroupViolation;
  sorted.m = static_cast<int>(value);
  return std::nullopt;
}

std::variant<Sorted, GrblError> Sort(const std::vector<GcodeWord>& words, const std::string& axes) {
  const std::string known = axes + "FSPNT";
  Sorted sorted;
  std::set<Group> groups;
  for (const GcodeWord& word : words) {
    std::optional<GrblError> error;
    if (word.letter == 'G') {
      error = SortG(word.value, groups, sorted);
    } else if (word.letter == 'M') {
      error = SortM(word.value, sorted);
    } else if (known.find(word.letter) == std::string::npos) {
      error = GrblError::kUnsupportedCommand;
    } else if (!sorted.values.emplace(word.letter, word.value).second) {
      error = GrblError::kWordRepeated;
    } else if (std::string("FSPNT").find(word.letter) != std::string::npos && word.value < 0.0) {
      error = GrblError::kNegativeValue;
    }
    if (error) return *error;
  }
  return sorted;
}

std::optional<double> Take(Sorted& sorted, char letter) {
  const auto found = sorted.values.find(letter);
  if (found == sorted.values.end()) return std::nullopt;
  const double value = found->second;
  sorted.values.erase(found);
  return value;
}

void ChangeModes(Sorted& sorted, GcodeModes& modes) {
  const auto has = [&](int g) { return sorted.g.contains(g); };
  if (has(20) || has(21)) modes.inches = has(20);
  if (has(90) || has(91)) modes.relative = has(91);
  if (has(93) || has(94)) {
    // A feed of the one mode means nothing in the other.
    if (modes.inverse_time != has(93)) modes.feed = 0.0;
    modes.inverse_time = has(93);
  }
  for (const int motion : {0, 1, kNoMotion})
    if (has(motion)) modes.motion = motion;
  if (const auto speed = Take(sorted, 'S')) modes.spindle_speed = *speed;
  if (sorted.m) modes.spindle = *sorted.m;
}

// The move's feed in deg/min, and the modal one. way: deg.
std::optional<GrblError> SetFeed(const std::optional<double>& word, double way, bool moves,
                                 GcodeBlock& block) {
  GcodeModes& modes = block.modes;
  const double unit = modes.inches ? kMmPerInch : 1.0;
  if (modes.inverse_time) {  // F is 1/minutes, and of this block only
    modes.feed = 0.0;
    if (!moves || modes.motion != 1) return std::nullopt;
    if (!word || *word <= 0.0) return GrblError::kUndefinedFeedRate;
    block.feed = way * *word;
    return std::nullopt;
  }
  if (word) modes.feed = *word * unit;
  if (!moves || modes.motion != 1) return std::nullopt;
  if (modes.feed <= 0.0) return GrblError::kUndefinedFeedRate;
  block.feed = modes.feed;
  return std::nullopt;
}

}  // namespace

std::variant<std::vector<GcodeWord>, GrblError> SplitGcode(const std::string& block) {
  std::vector<GcodeWord> words;
  std::size_t i = 0;
  while (i < block.size()) {
    const char letter = block[i++];
    if (letter < 'A' || letter > 'Z') return GrblError::kExpectedLetter;
    std::string number;
    while (i < block.size() && (std::string("+-.0123456789").find(block[i]) != std::string::npos))
      number += block[i++];
    char* end = nullptr;
    const double value = std::strtod(number.c_str(), &end);
    if (number.empty() || *end != '\0') return GrblError::kBadNumber;
    words.push_back({letter, value});
  }
  return words;
}

std::variant<GcodeBlock, GrblError> ReadGcode(const std::string& text, const GcodeModes& modes,
                                              char axis, const std::string& axes, double position) {
  const auto words = SplitGcode(text);
  if (const auto* error = std::get_if<GrblError>(&words)) return *error;
  auto sorting = Sort(std::get<std::vector<GcodeWord>>(words), axes);
  if (const auto* error = std::get_if<GrblError>(&sorting)) return *error;
  Sorted& sorted = std::get<Sorted>(sorting);

  GcodeBlock block;
  block.modes = modes;
  ChangeModes(sorted, block.modes);
  block.spindle_changes =
      block.modes.spindle != modes.spindle || block.modes.spindle_speed != modes.spindle_speed;
  if (sorted.g.contains(4)) {
    block.dwell_s = Take(sorted, 'P');
    if (!block.dwell_s) return GrblError::kValueWordMissing;
  }
  const double unit = block.modes.inches ? kMmPerInch : 1.0;
  bool axis_words = false;
  double target = position;
  for (const char letter : axes) {
    const auto value = Take(sorted, letter);
    axis_words = axis_words || value.has_value();
    if (!value || letter != axis) continue;
    const bool relative = block.modes.relative && !sorted.g.contains(53);
    target = relative ? position + *value * unit : *value * unit;
  }
  if (axis_words && (block.modes.motion == kNoMotion || block.dwell_s))
    return GrblError::kUnusedWords;
  if (!std::isfinite(target)) return GrblError::kInvalidTarget;
  const auto feed = Take(sorted, 'F');
  if (const auto error =
          SetFeed(feed, std::abs(target - position), axis_words || sorted.g.contains(1), block))
    return *error;
  Take(sorted, 'N');
  Take(sorted, 'T');
  if (!sorted.values.empty()) return GrblError::kUnusedWords;
  if (axis_words) block.target = target;
  return block;
}

}  // namespace turnlight::rig::sim::stage
