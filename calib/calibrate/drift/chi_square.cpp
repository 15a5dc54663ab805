#include "calib/calibrate/drift/chi_square.h"

#include <cmath>
#include <numbers>

namespace turnlight::calib::calibrate::drift {

// Q(x | n) = Q(x | n - 2) + (x / 2)^(n/2 - 1) e^(-x/2) / Gamma(n / 2), from Q(x | 2) = e^(-x/2) or
// Q(x | 1) = erfc(sqrt(x / 2)): Abramowitz and Stegun 26.4.4 and 26.4.5.
double ChiSquareTail(double value, int freedom) {
  if (!(value > 0.0)) return 1.0;
  const double half = 0.5 * value;
  const bool odd = freedom % 2 == 1;
  double tail = odd ? std::erfc(std::sqrt(half)) : std::exp(-half);
  double term =
      odd ? 2.0 * std::sqrt(half * std::numbers::inv_pi) * std::exp(-half) : half * std::exp(-half);
  for (int n = odd ? 3 : 4; n <= freedom; n += 2) {
    tail += term;
    term *= value / n;
  }
  return tail;
}

}  // namespace turnlight::calib::calibrate::drift
