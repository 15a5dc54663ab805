// Half-precision numbers for what needs two to three digits.
#pragma once

#include <bit>
#include <cstdint>

namespace turnlight::estimator::observe {

// bfloat16: the upper half of a float, rounded to nearest even.
using BFloat16 = std::uint16_t;

inline BFloat16 ToBFloat16(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return static_cast<BFloat16>((bits + 0x7FFFu + (bits >> 16 & 1u)) >> 16);
}

inline float FromBFloat16(BFloat16 value) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(value) << 16);
}

}  // namespace turnlight::estimator::observe
