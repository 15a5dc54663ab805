// Sixteen pixels side by side: arithmetic on GCC's vector types, with a logarithm and an
// exponential of single precision made of nothing but additions, multiplications and one division,
// so that every instruction set gives the same bits.
//
// To be included only by the variants of the tile kernel: everything here is in an unnamed
// namespace, compiled for that variant's instruction set.
#pragma once

#include <cstdint>
#include <cstring>

#include "estimator/solve/kernel/tile_kernel.h"

namespace turnlight::estimator::solve::kernel {
namespace {

#define TURNLIGHT_INLINE inline __attribute__((always_inline))
#define TURNLIGHT_LAMBDA __attribute__((always_inline))

template <typename Real>
struct LaneTypes;
template <>
struct LaneTypes<float> {
  typedef float V __attribute__((vector_size(kLanes * sizeof(float))));
  typedef std::int32_t I __attribute__((vector_size(kLanes * sizeof(std::int32_t))));
};
template <>
struct LaneTypes<double> {
  typedef double V __attribute__((vector_size(kLanes * sizeof(double))));
  typedef std::int64_t I __attribute__((vector_size(kLanes * sizeof(std::int64_t))));
};

template <typename Real>
struct Lanes {
  using V = typename LaneTypes<Real>::V;
  using I = typename LaneTypes<Real>::I;

  static TURNLIGHT_INLINE V Splat(double value) { return V{} + static_cast<Real>(value); }
  static TURNLIGHT_INLINE V Load(const Real* from) {
    V v;
    std::memcpy(&v, from, sizeof v);
    return v;
  }
  static TURNLIGHT_INLINE void Store(Real* to, V v) { std::memcpy(to, &v, sizeof v); }
  static TURNLIGHT_INLINE V Max(V a, V b) { return a > b ? a : b; }
  static TURNLIGHT_INLINE V Min(V a, V b) { return a < b ? a : b; }
  static TURNLIGHT_INLINE V Sqrt(V v) {
    // The builtin: an inline function of a library could be linked from here for other processors.
    for (int i = 0; i < kLanes; ++i)
      v[i] = static_cast<Real>(sizeof(Real) == 4 ? __builtin_sqrtf(static_cast<float>(v[i]))
                                                 : __builtin_sqrt(static_cast<double>(v[i])));
    return v;
  }
  static V LogOneMinus(V c);
  static V ExpNegative(V x);
  static TURNLIGHT_INLINE bool Any(I mask) {
    std::int64_t any = 0;
    for (int i = 0; i < kLanes; ++i) any |= mask[i];
    return any != 0;
  }
};

TURNLIGHT_INLINE Lanes<float>::V LoadFloats(const float* from, float) {
  return Lanes<float>::Load(from);
}
TURNLIGHT_INLINE Lanes<double>::V LoadFloats(const float* from, double) {
  Lanes<double>::V v;
  for (int i = 0; i < kLanes; ++i) v[i] = from[i];
  return v;
}
template <typename Real>
TURNLIGHT_INLINE typename Lanes<Real>::V LoadBFloat16(const std::uint16_t* from) {
  typename Lanes<Real>::V v;
  for (int i = 0; i < kLanes; ++i) {
    const std::uint32_t bits = static_cast<std::uint32_t>(from[i]) << 16;
    float value;
    std::memcpy(&value, &bits, sizeof value);
    v[i] = value;
  }
  return v;
}

template <typename Real>
TURNLIGHT_INLINE typename Lanes<Real>::V LoadBytes(const std::uint8_t* from) {
  typedef std::uint8_t B __attribute__((vector_size(kLanes)));
  B bytes;
  std::memcpy(&bytes, from, sizeof bytes);
  return __builtin_convertvector(bytes, typename Lanes<Real>::V);
}

// log(1 - c) for c in [0, 1). With t = fl(1 - c): log t * (-c) / (t - 1) undoes the rounding of t.
// log t from t = m 2^k, m in [sqrt 1/2, sqrt 2), log m = 2 atanh((m - 1) / (m + 1)).
template <>
TURNLIGHT_INLINE Lanes<float>::V Lanes<float>::LogOneMinus(Lanes<float>::V c) {
  using L = Lanes<float>;
  const L::V t = L::Max(1.0f - c, L::Splat(1e-30));
  L::I bits = (L::I)t;
  const L::I exponent = (bits - 0x3F3504F3) >> 23;
  bits -= exponent << 23;
  const L::V m = (L::V)bits;
  const L::V s = (m - 1.0f) / (m + 1.0f);
  const L::V z = s * s;
  const L::V series =
      1.0f +
      z * (0.333333333f + z * (0.2f + z * (0.142857143f + z * (0.111111111f + z * 0.0909f))));
  const L::V log_t =
      2.0f * s * series + __builtin_convertvector(exponent, L::V) * 0.693147180559945f;
  const L::V rounded = t - 1.0f;
  return rounded == 0.0f ? -c : log_t * (-c) / (rounded == 0.0f ? L::Splat(1.0) : rounded);
}
template <>
TURNLIGHT_INLINE Lanes<double>::V Lanes<double>::LogOneMinus(Lanes<double>::V c) {
  for (int i = 0; i < kLanes; ++i) c[i] = __builtin_log1p(-__builtin_fmin(c[i], 1.0 - 1e-16));
  return c;
}

// exp(x) for x <= 0, and exactly 0 below -40: denormal numbers would cost a hundred times a normal
// operation. x = k log 2 + r, |r| <= 0.35, Taylor's series of degree 7.
template <>
TURNLIGHT_INLINE Lanes<float>::V Lanes<float>::ExpNegative(Lanes<float>::V x) {
  using L = Lanes<float>;
  const L::V clamped = L::Max(x, L::Splat(-40.0));
  const L::I k = __builtin_convertvector(clamped * 1.44269504f - 0.5f, L::I);
  const L::V kf = __builtin_convertvector(k, L::V);
  const L::V r = clamped - kf * 0.693145752f - kf * 1.42860677e-6f;
  const L::V p =
      1.0f + r * (1.0f + r * (0.5f + r * (0.166666667f +
                                          r * (0.0416666667f +
                                               r * (0.00833333333f +
                                                    r * (0.00138888889f + r * 0.000198412698f))))));
  const L::V scale = (L::V)((k + 127) << 23);
  return x < -40.0f ? L::Splat(0.0) : p * scale;
}
template <>
TURNLIGHT_INLINE Lanes<double>::V Lanes<double>::ExpNegative(Lanes<double>::V x) {
  for (int i = 0; i < kLanes; ++i) x[i] = x[i] < -40.0 ? 0.0 : __builtin_exp(x[i]);
  return x;
}

template <typename Real>
struct Vector3 {
  using V = typename Lanes<Real>::V;
  V x, y, z;
  TURNLIGHT_INLINE V Dot(const Vector3& o) const { return x * o.x + y * o.y + z * o.z; }
  TURNLIGHT_INLINE Vector3 operator+(const Vector3& o) const { return {x + o.x, y + o.y, z + o.z}; }
  TURNLIGHT_INLINE Vector3 operator-(const Vector3& o) const { return {x - o.x, y - o.y, z - o.z}; }
  TURNLIGHT_INLINE Vector3 operator*(V s) const { return {x * s, y * s, z * s}; }
  TURNLIGHT_INLINE V InverseNorm() const { return Real(1) / Lanes<Real>::Sqrt(Dot(*this)); }
};
template <typename Real>
TURNLIGHT_INLINE Vector3<Real> SplatVector(const double* v) {
  using L = Lanes<Real>;
  return {L::Splat(v[0]), L::Splat(v[1]), L::Splat(v[2])};
}

}  // namespace
}  // namespace turnlight::estimator::solve::kernel
