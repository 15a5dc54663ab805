// A curve through a few points that only rises: a monotone cubic (Fritsch and Butland, 1984), with
// one continuous derivative. Beyond its ends it goes on straight.
#pragma once

#include <array>
#include <vector>

namespace turnlight::calib {

class MonotoneCurve {
 public:
  // At least two points (x, y), both strictly rising.
  explicit MonotoneCurve(const std::vector<std::array<double, 2>>& points);

  double At(double x) const;
  // The x at which the curve is y.
  double InverseAt(double y) const;

 private:
  double Inside(std::size_t piece, double t) const;

  std::vector<double> x_, y_, slope_;
};

}  // namespace turnlight::calib
