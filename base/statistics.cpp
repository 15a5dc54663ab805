#include "base/statistics.h"

namespace turnlight {

double InterpolatedQuantile(std::vector<double> values, double share) {
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  const double at = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const auto above = std::min(below + 1, values.size() - 1);
  const double part = at - static_cast<double>(below);
  // No infinity minus infinity.
  if (part == 0.0 || values[below] == values[above]) return values[below];
  return (1.0 - part) * values[below] + part * values[above];
}

}  // namespace turnlight
