#include "app/motion_words.h"

#include <cmath>
#include <cstdlib>

#include "base/format.h"

namespace turnlight::app {
namespace {

constexpr double kMaxDeg = 36000.0;

}  // namespace

std::optional<JogTarget> ParseJogTarget(const std::string& word) {
  JogTarget target;
  target.step = !word.empty() && word[0] == '+';
  const std::string number = word.substr(target.step ? 1 : 0);
  if (number.empty() || number.find_first_not_of("0123456789.-") != std::string::npos)
    return std::nullopt;
  char* end = nullptr;
  target.deg = std::strtod(number.c_str(), &end);
  if (*end != '\0' || !(std::abs(target.deg) <= kMaxDeg)) return std::nullopt;
  return target;
}

std::string TurnText(const std::string& table, double from_deg, double to_deg,
                     const rig::TableKinematics& kinematics) {
  const double way = to_deg - from_deg;
  const std::string begin = "the table " + table + " will turn from ";
  return begin + Format("%.3f to %.3f degrees, %.6g degrees %s, at %.4g deg/s, about %.2g s",
                        from_deg, to_deg, std::round(1e6 * std::abs(way)) * 1e-6,
                        way < 0.0 ? "clockwise" : "counter-clockwise", kinematics.speed_deg_per_s,
                        rig::MoveSeconds(kinematics, std::abs(way)));
}

std::string HomeText(const std::string& table) {
  return "the table " + table +
         " will home: it may turn by up to a whole turn and more, the way that its controller is "
         "set up for";
}

Result<DeviceWords> SplitWords(const std::vector<std::string>& words, const std::string& config,
                               const std::string& other, bool (*is_other)(const std::string&)) {
  DeviceWords split{config, ""};
  for (const std::string& word : words) {
    if (word.empty()) continue;
    const bool takes_other = !other.empty() && split.other.empty() && is_other(word);
    if (takes_other)
      split.other = word;
    else if (split.config.empty())
      split.config = word;
    else
      return InputError(word + ": one word too many, allowed are a config" +
                        (other.empty() ? "" : " and " + other));
  }
  if (split.config.empty())
    return InputError("no config is given, allowed is CONFIG or --config CONFIG");
  if (!other.empty() && split.other.empty()) return InputError("what is missing is " + other);
  return split;
}

}  // namespace turnlight::app
