// An encoding and its inverse, ready to be applied to many values.
#pragma once

#include <optional>

#include "calib/monotone_curve.h"
#include "calib/radiometry.h"

namespace turnlight::calib {

class Transfer {
 public:
  // Of the radiometry's encoding; the rest of it does not count.
  explicit Transfer(const Radiometry& radiometry);

  // From a share of white above black as stored to a linear share, and back.
  double Decode(double s) const;
  double Encode(double r) const;

 private:
  Encoding encoding_;
  double gamma_;
  std::optional<MonotoneCurve> curve_;
};

}  // namespace turnlight::calib
