#include "rig/session/number_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace turnlight::rig {
namespace {

// Whether a number that a double cannot hold is too large, not too small.
bool IsHuge(std::string_view word) {
  const std::size_t mark = word.find_first_of("eE");
  if (mark != std::string_view::npos)
    return word.substr(mark + 1).find('-') == std::string_view::npos;
  return word.find_first_of("123456789") < word.find('.');
}

}  // namespace

std::optional<double> NumberOf(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool whole = end == word.data() + word.size();
  if (code == std::errc() && whole) return value;
  if (code == std::errc::result_out_of_range && whole) {
    const double size = IsHuge(word) ? std::numeric_limits<double>::infinity() : 0.0;
    return word.starts_with('-') ? -size : size;
  }
  // As older libraries of Windows print what is not finite.
  if (code == std::errc() && *end == '#') {
    const std::string_view rest = word.substr(static_cast<std::size_t>(end - word.data()));
    if (rest.starts_with("#INF"))
      return std::copysign(std::numeric_limits<double>::infinity(), value);
    if (rest.starts_with("#QNAN") || rest.starts_with("#SNAN") || rest.starts_with("#IND"))
      return std::numeric_limits<double>::quiet_NaN();
  }
  return std::nullopt;
}

}  // namespace turnlight::rig
