// Order statistics of a few or of many values. Those that take a reference reorder the values.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace turnlight {

// What stands at this index when the values are in order; 0 of none.
template <typename Value>
Value OrderStatistic(std::vector<Value>& values, std::size_t index) {
  if (values.empty()) return Value{0};
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::min(index, values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// The upper of the two middle ones if their number is even; 0 of none.
template <typename Value>
Value Median(std::vector<Value>& values) {
  return OrderStatistic(values, values.size() / 2);
}

// The order statistic at or below the share, 0..1, of the way from the smallest to the largest; 0
// of none.
template <typename Value>
Value LowerQuantile(std::vector<Value>& values, double share) {
  if (values.empty()) return Value{0};
  return OrderStatistic(values,
                        static_cast<std::size_t>(static_cast<double>(values.size() - 1) * share));
}

// The smallest value that at least this share, 0..1, of the finite values does not exceed (nearest
// rank); 0 if none is finite.
template <typename Value>
Value NearestRank(std::vector<Value> values, double share) {
  std::erase_if(values, [](Value value) { return !std::isfinite(value); });
  const double rank = std::ceil(share * static_cast<double>(values.size())) - 1.0;
  return OrderStatistic(values, static_cast<std::size_t>(std::max(rank, 0.0)));
}

// Linear between the order statistics, share 0..1; NaN of none. Infinities stay themselves.
double InterpolatedQuantile(std::vector<double> values, double share);

// The median of |x| of a unit normal x: a median magnitude divided by it is a sigma.
inline constexpr double kMedianOfNormal = 0.6745;

// Sigma of white noise from the sizes of its second differences a - 2 b + c, which what changes
// slowly hardly moves: from one of their quantiles, and the same quantile of |x| of a unit normal
// x.
template <typename Value>
Value SigmaOfSecondDifference(Value quantile, Value of_unit_normal) {
  return quantile / (of_unit_normal * std::sqrt(Value{6}));
}

}  // namespace turnlight
