// Phong, "Illumination for Computer Generated Pictures" (CACM 1975): f_s = (r.v)^n = (w.l)^n with w
// the mirrored view; not normalised, and without a factor n.l. Its shape is the exponent n.
#pragma once

#include <cmath>

#include "estimator/model/reflectance/terms.h"

namespace turnlight::estimator::model::reflectance {

// (axis . x)^n, which Blinn-Phong has of other vectors.
template <typename M>
LobeTerm<M> CosinePower(double exponent, const LobeArguments<M>& at) {
  using V = typename M::V;
  const V zero = M::Splat(0.0), one = M::Splat(1.0), n = M::Splat(exponent);
  const V& c = at.below_one;
  const V cosine = M::Max(one - c, M::Splat(1e-6));
  const V logarithm = M::LogOneMinus(M::Min(c, M::Splat(1.0 - 1e-6)));
  const V power = one - c > zero ? at.weight * M::ExpNegative(n * logarithm) : zero;
  return {power, n * power / cosine, zero, zero, power * logarithm, zero};
}

struct Phong {
  static constexpr LobeFacts kFacts{"phong", "Phong", "shininess", 0.5, 1e5, true, false, true};

  template <typename M>
  static LobeTerm<M> Evaluate(double shape, double /*f0*/, const LobeArguments<M>& at) {
    return CosinePower<M>(shape, at);
  }
  // 1 over the variance of the angle between axis and vector, radians: that of the Gaussian lobe
  // that has the same curvature at its peak.
  static double InverseVariance(double shape) { return shape; }
  static double ShapeOf(double inverse_variance) { return inverse_variance; }
  // The angle between axis and vector at which half of the peak is left.
  static double HalfWidth(double shape) { return std::acos(std::exp2(-1.0 / shape)); }
};

}  // namespace turnlight::estimator::model::reflectance
