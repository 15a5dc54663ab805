#include "calib/transfer.h"

#include <cmath>

namespace turnlight::calib {
namespace {

// IEC 61966-2-1. The linear part goes on below 0.
constexpr double kSrgbKnee = 0.04045;
constexpr double kSrgbSlope = 12.92;

}  // namespace

Transfer::Transfer(const Radiometry& radiometry)
    : encoding_(radiometry.encoding), gamma_(radiometry.gamma) {
  if (encoding_ == Encoding::kCurve) curve_.emplace(radiometry.curve);
}

double Transfer::Decode(double s) const {
  switch (encoding_) {
    case Encoding::kLinear:
      return s;
    case Encoding::kSrgb:
      return s <= kSrgbKnee ? s / kSrgbSlope : std::pow((s + 0.055) / 1.055, 2.4);
    case Encoding::kGamma:
      return std::copysign(std::pow(std::abs(s), gamma_), s);
    case Encoding::kCurve:
      return curve_->At(s);
  }
  return s;
}

double Transfer::Encode(double r) const {
  switch (encoding_) {
    case Encoding::kLinear:
      return r;
    case Encoding::kSrgb:
      return r <= kSrgbKnee / kSrgbSlope ? r * kSrgbSlope : 1.055 * std::pow(r, 1.0 / 2.4) - 0.055;
    case Encoding::kGamma:
      return std::copysign(std::pow(std::abs(r), 1.0 / gamma_), r);
    case Encoding::kCurve:
      return curve_->InverseAt(r);
  }
  return r;
}

}  // namespace turnlight::calib
