// Arithmetic on single numbers: double, or a type of automatic differentiation.
#pragma once

#include <cmath>

namespace turnlight::estimator::model::reflectance {

template <typename T>
struct Scalar {
  using V = T;
  static T Splat(double value) { return T(value); }
  static T Max(const T& a, const T& b) { return a > b ? a : b; }
  static T Min(const T& a, const T& b) { return a < b ? a : b; }
  static T Sqrt(const T& x) {
    using std::sqrt;
    return sqrt(x);
  }
  static T LogOneMinus(const T& c) {
    using std::log1p;
    return log1p(-c);
  }
  static T ExpNegative(const T& x) {
    using std::exp;
    return exp(x);
  }
};

}  // namespace turnlight::estimator::model::reflectance
