#include "calib/monotone_curve.h"

#include <algorithm>
#include <cassert>

namespace turnlight::calib {
namespace {

constexpr int kBisections = 60;  // of a piece: to the last bit
// Of a piece's own slope: 3 is the most with which a cubic stays monotone; more than 0 is needed to
// go on beyond an end.
constexpr double kLeastEndSlope = 0.1, kMostEndSlope = 3.0;

}  // namespace

MonotoneCurve::MonotoneCurve(const std::vector<std::array<double, 2>>& points) {
  assert(points.size() >= 2);
  for (const auto& [x, y] : points) {
    assert(x_.empty() || (x > x_.back() && y > y_.back()));
    x_.push_back(x);
    y_.push_back(y);
  }
  const std::size_t n = x_.size();
  slope_.resize(n);
  const auto width = [&](std::size_t k) { return x_[k + 1] - x_[k]; };
  const auto rise = [&](std::size_t k) { return (y_[k + 1] - y_[k]) / width(k); };
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double a = 2.0 * width(i) + width(i - 1), b = width(i) + 2.0 * width(i - 1);
    slope_[i] = (a + b) / (a / rise(i - 1) + b / rise(i));
  }
  // At an end the parabola through three points says how the slope goes on.
  const auto end = [&](std::size_t own, std::size_t next) {
    const double slope = rise(own) + (rise(own) - rise(next)) * width(own) /
                                         (width(own) + width(next));
    return std::clamp(slope, kLeastEndSlope * rise(own), kMostEndSlope * rise(own));
  };
  slope_.front() = n > 2 ? end(0, 1) : rise(0);
  slope_.back() = n > 2 ? end(n - 2, n - 3) : rise(0);
}

double MonotoneCurve::Inside(std::size_t piece, double t) const {
  const double h = x_[piece + 1] - x_[piece], u = 1.0 - t;
  return u * u * ((1.0 + 2.0 * t) * y_[piece] + t * h * slope_[piece]) +
         t * t * ((3.0 - 2.0 * t) * y_[piece + 1] - u * h * slope_[piece + 1]);
}

double MonotoneCurve::At(double x) const {
  if (!(x > x_.front())) return y_.front() + (x - x_.front()) * slope_.front();
  if (!(x < x_.back())) return y_.back() + (x - x_.back()) * slope_.back();
  const auto piece =
      static_cast<std::size_t>(std::upper_bound(x_.begin(), x_.end(), x) - x_.begin()) - 1;
  return Inside(piece, (x - x_[piece]) / (x_[piece + 1] - x_[piece]));
}

double MonotoneCurve::InverseAt(double y) const {
  if (!(y > y_.front())) return x_.front() + (y - y_.front()) / slope_.front();
  if (!(y < y_.back())) return x_.back() + (y - y_.back()) / slope_.back();
  const auto piece =
      static_cast<std::size_t>(std::upper_bound(y_.begin(), y_.end(), y) - y_.begin()) - 1;
  double low = 0.0, high = 1.0;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    (Inside(piece, middle) < y ? low : high) = middle;
  }
  return x_[piece] + 0.5 * (low + high) * (x_[piece + 1] - x_[piece]);
}

}  // namespace turnlight::calib
