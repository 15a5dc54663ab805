// Real spherical harmonics of orders 1 and 2, each with a mean square of 1 over the sphere
// (geodesy's normalisation; order 0 is 1). A distant light field of radiance L_0 + sum_j L_j Y_j
// gives a matte surface of normal n pi (L_0 + 2/3 sum_1 L_j Y_j(n) + 1/4 sum_2 L_j Y_j(n)), the
// sums over orders 1 and 2; higher ones hardly matter (Ramamoorthi and Hanrahan, "An Efficient
// Representation for Irradiance Environment Maps", SIGGRAPH 2001).
#pragma once

namespace turnlight::estimator::model {

inline constexpr int kHarmonics = 8;

// Their values at (x, y, z), unit. M is an arithmetic, as for reflectance (reflectance/terms.h).
template <typename M>
inline __attribute__((always_inline)) void FillHarmonics(typename M::V x, typename M::V y,
                                                         typename M::V z, typename M::V* out) {
  const auto times = [](double factor, typename M::V value) __attribute__((always_inline)) {
    return M::Splat(factor) * value;
  };
  constexpr double kRoot3 = 1.7320508075688772, kRoot5 = 2.23606797749979;
  out[0] = times(kRoot3, x);
  out[1] = times(kRoot3, y);
  out[2] = times(kRoot3, z);
  out[3] = times(kRoot3 * kRoot5, x * y);
  out[4] = times(kRoot3 * kRoot5, y * z);
  out[5] = times(kRoot3 * kRoot5, x * z);
  out[6] = times(0.5 * kRoot5, M::Splat(3.0) * z * z - M::Splat(1.0));
  out[7] = times(0.5 * kRoot3 * kRoot5, x * x - y * y);
}

}  // namespace turnlight::estimator::model
